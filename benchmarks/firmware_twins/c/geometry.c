/* Twin of tinyphoon/geometry.py. */
#include "geometry.h"
#include "lines.h"

#define GEOMETRY_FOCAL 0
#define GEOMETRY_BASELINE 1
#define GEOMETRY_SHIFT_X 6
#define GEOMETRY_SHIFT_Y 7
#define MICROMETRES 1000
#define FARTHEST_MM 32767

KERNEL int32_t depth_mm(const int32_t geometry[], int32_t disparity)
{
    if (disparity <= 0)
        return 0;
    int32_t reach = geometry[GEOMETRY_FOCAL] * geometry[GEOMETRY_BASELINE];
    int32_t depth = floor_div(floor_div(reach, disparity) + MICROMETRES / 2, MICROMETRES);
    return depth <= FARTHEST_MM ? depth : 0;
}

KERNEL int32_t beside_mm(const int32_t geometry[], int32_t depth, int32_t off_axis)
{
    int32_t focal = geometry[GEOMETRY_FOCAL];
    return floor_div(2 * depth * off_axis + focal, 2 * focal);
}

KERNEL int32_t store_point(const int32_t geometry[], int32_t x, int32_t y, int32_t disparity, int32_t width,
                           int32_t height, int16_t words[], int32_t at)
{
    int32_t depth = depth_mm(geometry, disparity);
    int32_t across = beside_mm(geometry, depth, x - (SUBPIXELS * (width - 1) >> 1) - geometry[GEOMETRY_SHIFT_X]);
    int32_t down = beside_mm(geometry, depth, y - (SUBPIXELS * (height - 1) >> 1) - geometry[GEOMETRY_SHIFT_Y]);
    if (depth == 0 || abs(across) > FARTHEST_MM || abs(down) > FARTHEST_MM)
        return 0;
    words[at] = (int16_t)across;
    words[at + 1] = (int16_t)down;
    words[at + 2] = (int16_t)depth;
    return 1;
}
