/* Twin of tinyphoon/stages/circle_outline.py: `refine_row`. */
#include "circle_edges.h"
#include "circle_fit.h"
#include "line_segments.h"

#define LUMA_LINES 16
#define REACH_LINES 8
#define BEFORE (REACH_LINES - 1)
#define RISES (2 * REACH_LINES - 1)
#define FIRST_PLACE (BEFORE - 2)
#define LAST_PLACE (BEFORE + 1)
#define MOST_BESIDE 4

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

HELPER void fill_rises(const uint8_t luma[], int32_t x, int32_t y, int32_t way, int32_t flat, int32_t height,
                       int32_t rises[], int32_t luma_length)
{
    int32_t here = profile_pixel(luma, x, y, -way * BEFORE, flat, height, luma_length);
    for (int32_t place = 0; place < RISES; place++) {
        int32_t ahead = profile_pixel(luma, x, y, way * (place + 1 - BEFORE), flat, height, luma_length);
        rises[place] = ahead - here;
        here = ahead;
    }
}

HELPER int32_t steepest(const int32_t rises[])
{
    int32_t best = FIRST_PLACE;
    int32_t most = rises[best - 1] + 2 * rises[best] + rises[best + 1];
    for (int32_t place = FIRST_PLACE + 1; place < LAST_PLACE + 1; place++) {
        int32_t rise = rises[place - 1] + 2 * rises[place] + rises[place + 1];
        if (rise > most) {
            most = rise;
            best = place;
        }
    }
    return best;
}

HELPER int32_t flank(const int32_t rises[], int32_t at, int32_t way)
{
    int32_t beside = 1;
    while (beside < MOST_BESIDE && 2 * rises[at + way * beside] > rises[at])
        beside = beside + 1;
    return beside;
}

HELPER int32_t outline_offset(const int32_t rises[], int32_t at, int32_t before, int32_t after, int32_t fit[])
{
    int32_t dark_slope = max(rises[at - before - 1], 0);
    int32_t bright_slope = max(rises[at + after + 1], 0);
    int32_t whole = max(rises[at] - ((dark_slope + bright_slope) >> 1), 0);
    int32_t moment = 0;
    int32_t square = 0;
    int32_t dark_end = (before + 1) * dark_slope;
    int32_t bright_end = (after + 1) * bright_slope;
    for (int32_t step = 1; step < before + 1; step++) {
        int32_t rise = max(rises[at - step] - dark_slope, 0);
        whole = whole + rise;
        moment = moment - step * rise;
        square = square + step * (step * rises[at - step] - dark_end);
    }
    for (int32_t step = 1; step < after + 1; step++) {
        int32_t rise = max(rises[at + step] - bright_slope, 0);
        whole = whole + rise;
        moment = moment + step * rise;
        square = square + step * (step * rises[at + step] - bright_end);
    }
    int32_t steep = max(rises[at], 0);
    fit[RISE_SUM] = fit[RISE_SUM] + steep * whole;
    fit[SQUARE_SUM] = fit[SQUARE_SUM] + steep * max(square, 0);
    int32_t offset = FINE * (at - BEFORE) + FINE / 2;
    if (whole > 0)
        offset = offset + floor_div(2 * FINE * moment + whole, 2 * whole);
    return offset;
}

KERNEL void refine_row(uint32_t selected[], int32_t count, int32_t y, const uint8_t luma[], int32_t height,
                       int32_t fit[], int32_t fit_range, int32_t rises[], uint16_t steepness[], int32_t luma_length)
{
    int32_t number = fit[NEXT_EDGE];
    while (number < count && edge_y(selected[number]) == y) {
        uint32_t edge = selected[number];
        int32_t direction = (int32_t)(edge & 255);
        int32_t x = FINE * edge_x(edge);
        if (abs(distance(x, FINE * y, fit) - fit[RADIUS]) <= FINE * fit_range) {
            int32_t flat = is_flat(direction);
            int32_t way = ((direction - 64 * flat + 64) & 128) == 0 ? 1 : -1;
            fill_rises(luma, edge_x(edge), y, way, flat, height, rises, luma_length);
            int32_t at = steepest(rises);
            int32_t before = flank(rises, at, -1);
            int32_t after = flank(rises, at, 1);
            int32_t offset = way * outline_offset(rises, at, before, after, fit);
            int32_t across = max(offset * (1 - flat) + x, 0);
            int32_t down = max(offset * flat + FINE * y, 0);
            int32_t point = fit[REFINED];
            selected[point] = (uint32_t)(across | down << 16);
            steepness[point] = (uint16_t)max(rises[at], 0);
            fit[REFINED] = point + 1;
        }
        number = number + 1;
    }
    fit[NEXT_EDGE] = number;
}
