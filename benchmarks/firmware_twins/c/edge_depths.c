/* Twin of tinyphoon/stages/edge_depths.py. */
#include "geometry.h"
#include "lines.h"

/* half-words of a 3-D edge */
#define EDGE3D_X 0
#define EDGE3D_LEFT 3
#define EDGE3D_WORDS 4

KERNEL int32_t store_edges3d_row(const uint32_t edge_data[], const uint32_t edge_index[], int32_t y,
                                 const uint32_t left_row[], int32_t left_count, const int16_t disparities[],
                                 int32_t farthest, const int32_t geometry[], int32_t width, int32_t height,
                                 int16_t edges_3d[], int32_t found, int32_t edges_3d_length)
{
    int32_t place = (int32_t)edge_index[y];
    for (int32_t left = 0; left < left_count; left++) {
        uint32_t edge = left_row[left];
        int32_t x = (int32_t)(edge >> 16);
        int32_t disparity = disparities[left];
        if (disparity > farthest) {
            int32_t base = EDGE3D_WORDS * found;
            int32_t stored = 1;
            if (base < edges_3d_length)
                stored = store_point(geometry, SUBPIXELS * x, SUBPIXELS * y, disparity, width, height,
                                     edges_3d, base + EDGE3D_X);
            if (stored != 0 && base < edges_3d_length) {
                while (edge_data[place] != edge)
                    place = place + 1;
                edges_3d[base + EDGE3D_LEFT] = (int16_t)place;
            }
            found = found + stored;
        }
    }
    return found;
}
