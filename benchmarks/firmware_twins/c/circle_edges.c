/* Twin of tinyphoon/stages/circle_edges.py: `select_edges_row`. */
#include "circle_edges.h"
#include "arithmetic.h"
#include "line_segments.h"

#define HALF_TURN 128
#define AWAY_BIT 19

KERNEL int32_t edge_x(uint32_t edge)
{
    return (int32_t)(edge >> 20);
}

KERNEL int32_t edge_y(uint32_t edge)
{
    return (int32_t)(edge >> 8 & 0x7FF);
}

KERNEL int32_t looks_away(uint32_t edge)
{
    return (int32_t)(edge >> AWAY_BIT & 1);
}

HELPER int32_t is_overlaid(const uint32_t above[], const uint32_t here[], const uint32_t below[], int32_t x,
                           uint32_t colours)
{
    for (int32_t column = x - 1; column < x + 2; column++) {
        if ((above[column] & colours) == 0 || (here[column] & colours) == 0 || (below[column] & colours) == 0)
            return 0;
    }
    return 1;
}

HELPER int32_t is_near_colour(const uint32_t above[], const uint32_t here[], const uint32_t below[], int32_t x,
                              uint32_t colours, int32_t here_length)
{
    int32_t stop = min(x + 3, here_length);
    for (int32_t column = max(x - 2, 0); column < stop; column++) {
        if (((above[column] | here[column] | below[column]) & colours) != 0)
            return 1;
    }
    return 0;
}

HELPER int32_t looks_along(int32_t direction, int32_t dx, int32_t dy, int32_t angle_range, const uint8_t atan[])
{
    int32_t turn = abs(turn_between(direction, angle8(dx, dy, atan)));
    if (turn <= angle_range)
        return 1;
    return turn >= HALF_TURN - angle_range ? -1 : 0;
}

KERNEL int32_t select_edges_row(const uint32_t edge_data[], const uint32_t edge_index[],
                                const uint16_t edge_counts[], int32_t y, const uint32_t above[],
                                const uint32_t here[], const uint32_t below[], uint32_t colours, int32_t area[],
                                int32_t angle_range, int32_t beside_colour, const uint8_t atan[],
                                uint32_t selected[], int32_t found, int32_t here_length, int32_t selected_length)
{
    int32_t first = (int32_t)edge_index[y];
    int32_t stop = first + edge_counts[y];
    for (int32_t position = first; position < stop; position++) {
        uint32_t edge = edge_data[position];
        int32_t x = (int32_t)(edge >> 16);
        if (area[LEFT] <= x && x <= area[RIGHT] && is_overlaid(above, here, below, x, colours) == 0) {
            area[BORDERING] = area[BORDERING] + 1;
            uint32_t direction = edge >> 8 & 255;
            int32_t dx = area[MASS_X] - x;
            int32_t dy = area[MASS_Y] - y;
            int32_t looks = looks_along((int32_t)direction, dx, dy, angle_range, atan);
            if (looks < 0 && beside_colour != 0 && is_near_colour(above, here, below, x, colours, here_length) == 0)
                looks = 0;
            if (looks != 0) {
                if (found < selected_length) {
                    int32_t away = looks < 0 ? 1 : 0;
                    selected[found] = direction | (uint32_t)(y << 8 | away << AWAY_BIT) | (uint32_t)(x << 20);
                }
                found = found + 1;
            }
        }
    }
    return found;
}
