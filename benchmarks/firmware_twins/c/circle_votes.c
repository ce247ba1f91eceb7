/* Twin of tinyphoon/stages/circle_votes.py: `draw_lines`. */
#include "circle_edges.h"
#include "line_segments.h"

#define TANGENT_BITS 12
#define HALF_CELL (1 << (TANGENT_BITS - 1))

HELPER int32_t gradient_slope(int32_t direction, const uint16_t tangents[])
{
    int32_t turn = ((direction + 32) & 63) - 32;
    if (is_flat(direction) != 0)
        turn = -turn;
    return turn >= 0 ? tangents[turn] : -tangents[-turn];
}

KERNEL void draw_lines(const uint32_t selected[], int32_t count, uint16_t votes[], const int32_t area[],
                       const uint16_t tangents[])
{
    int32_t side = 2 * area[REACH] + 1;
    int32_t left = area[MASS_X] - area[REACH];
    int32_t top = area[MASS_Y] - area[REACH];
    for (int32_t number = 0; number < count; number++) {
        uint32_t edge = selected[number];
        int32_t direction = (int32_t)(edge & 255);
        int32_t slope = gradient_slope(direction, tangents);
        int32_t x = edge_x(edge) - left;
        int32_t y = edge_y(edge) - top;
        int32_t across, step, stride;
        if (is_flat(direction) == 0) {
            across = (y << TANGENT_BITS) - slope * x + HALF_CELL;
            step = 1;
            stride = side;
        } else {
            across = (x << TANGENT_BITS) - slope * y + HALF_CELL;
            step = side;
            stride = 1;
        }
        int32_t at = 0;
        for (int32_t i = 0; i < side; i++) {
            int32_t cell = across >> TANGENT_BITS;
            if (0 <= cell && cell < side) {
                int32_t place = at + cell * stride;
                votes[place] = (uint16_t)(votes[place] + 1);
            }
            across = across + slope;
            at = at + step;
        }
    }
}
