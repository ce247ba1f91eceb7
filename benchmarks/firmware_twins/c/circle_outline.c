/* Twin of tinyphoon/stages/circle_outline.py: `refine_row`. */
#include "circle_edges.h"
#include "circle_fit.h"
#include "line_segments.h"

#define LUMA_LINES 16

HELPER int32_t profile_pixel(const uint8_t luma[], int32_t x, int32_t y, int32_t step, int32_t flat, int32_t height,
                             int32_t luma_length)
{
    int32_t width = luma_length >> 4;
    if (flat != 0)
        y = min(max(y + step, 0), height - 1);
    else
        x = min(max(x + step, 0), width - 1);
    return luma[(y & (LUMA_LINES - 1)) * width + x];
}

HELPER int32_t step_at(const uint8_t luma[], int32_t x, int32_t y, int32_t at, int32_t way, int32_t flat,
                       int32_t height, int32_t luma_length)
{
    int32_t here = profile_pixel(luma, x, y, way * at, flat, height, luma_length);
    return profile_pixel(luma, x, y, way * (at + 1), flat, height, luma_length) - here;
}

HELPER int32_t outline_offset(const uint8_t luma[], int32_t x, int32_t y, int32_t way, int32_t flat, int32_t height,
                              int32_t luma_length)
{
    int32_t best = -2;
    int32_t middle = step_at(luma, x, y, best, way, flat, height, luma_length);
    for (int32_t at = -1; at < 2; at++) {
        int32_t rise = step_at(luma, x, y, at, way, flat, height, luma_length);
        if (rise > middle) {
            middle = rise;
            best = at;
        }
    }
    int32_t dark_slope = max(step_at(luma, x, y, best - 2, way, flat, height, luma_length), 0);
    int32_t bright_slope = max(step_at(luma, x, y, best + 2, way, flat, height, luma_length), 0);
    int32_t before = max(step_at(luma, x, y, best - 1, way, flat, height, luma_length) - dark_slope, 0);
    int32_t after = max(step_at(luma, x, y, best + 1, way, flat, height, luma_length) - bright_slope, 0);
    int32_t whole = before + after + max(middle - ((dark_slope + bright_slope) >> 1), 0);
    int32_t offset = FINE * best + FINE / 2;
    if (whole > 0)
        offset = offset + floor_div(2 * FINE * (after - before) + whole, 2 * whole);
    return offset;
}

KERNEL void refine_row(uint32_t selected[], int32_t count, int32_t y, const uint8_t luma[], int32_t height,
                       int32_t fit[], int32_t fit_range, int32_t luma_length)
{
    int32_t number = fit[NEXT_EDGE];
    while (number < count && edge_y(selected[number]) == y) {
        uint32_t edge = selected[number];
        int32_t direction = (int32_t)(edge & 255);
        int32_t x = FINE * edge_x(edge);
        if (abs(distance(x, FINE * y, fit) - fit[RADIUS]) <= FINE * fit_range) {
            int32_t flat = is_flat(direction);
            int32_t way = ((direction - 64 * flat + 64) & 128) == 0 ? 1 : -1;
            int32_t offset = way * outline_offset(luma, edge_x(edge), y, way, flat, height, luma_length);
            int32_t across = max(offset * (1 - flat) + x, 0);
            int32_t down = max(offset * flat + FINE * y, 0);
            selected[fit[REFINED]] = (uint32_t)(across | down << 16);
            fit[REFINED] = fit[REFINED] + 1;
        }
        number = number + 1;
    }
    fit[NEXT_EDGE] = number;
}
