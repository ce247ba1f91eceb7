/* Twin of tinyphoon/stages/line_fit.py. */
#include "line_fit.h"
#include "arithmetic.h"
#include "line_segments.h"
#include "lines.h"

#define HALF_PIXEL (SUBPIXELS / 2)
#define WIDEST (1 << (30 - SLOPE_BITS))

KERNEL int32_t spread(int32_t products, int32_t sum_a, int32_t sum_b, int32_t edges)
{
    int32_t mean_a = floor_div(sum_a, edges);
    int32_t mean_b = floor_div(sum_b, edges);
    int32_t rest_a = sum_a - edges * mean_a;
    int32_t rest_b = sum_b - edges * mean_b;
    return products - mean_a * sum_b - mean_b * rest_a - floor_div(rest_a * rest_b, edges);
}

KERNEL int32_t slope(int32_t along, int32_t across)
{
    while (along >= WIDEST || abs(across) >= WIDEST) {
        along = along >> 1;
        across = across >> 1;
    }
    if (along == 0)
        return 0;
    return floor_div(across << SLOPE_BITS, along);
}

HELPER int32_t foot(int32_t along, int32_t across, int32_t rise)
{
    int32_t length = (1 << SLOPE_BITS) + (rise * rise >> SLOPE_BITS);
    return floor_div((along << SLOPE_BITS) + rise * across + (length >> 1), length);
}

HELPER int32_t border_position(int32_t x, int32_t y, int32_t dx, int32_t dy, int32_t right, int32_t bottom)
{
    int32_t to_side = max(dx > 0 ? right - x : x, 0);
    int32_t to_level = max(dy > 0 ? bottom - y : y, 0);
    int32_t position;
    if (to_side * abs(dy) <= to_level * abs(dx)) {
        int32_t level = y;
        if (dx != 0)
            level = y + floor_div(to_side * dy, abs(dx));
        position = dx > 0 ? right + level : 2 * right + 2 * bottom - level;
    } else {
        int32_t side = x + floor_div(to_level * dx, abs(dy));
        position = dy > 0 ? 2 * right + bottom - side : side;
    }
    return position >> 4;
}

KERNEL void store_ends(int16_t lines[], int32_t line, int32_t x0, int32_t y0, int32_t x1, int32_t y1,
                       const uint8_t atan[], int32_t width, int32_t height)
{
    int32_t base = line * LINE_WORDS;
    int32_t dx = x1 - x0;
    int32_t dy = y1 - y0;
    int32_t right = SUBPIXELS * (width - 1);
    int32_t bottom = SUBPIXELS * (height - 1);
    lines[base + LINE_X0] = (int16_t)x0;
    lines[base + LINE_Y0] = (int16_t)y0;
    lines[base + LINE_X1] = (int16_t)x1;
    lines[base + LINE_Y1] = (int16_t)y1;
    lines[base + LINE_ANGLE] = (int16_t)angle8(dx, dy, atan);
    lines[base + LINE_BEHIND] = (int16_t)border_position(x0, y0, -dx, -dy, right, bottom);
    lines[base + LINE_AHEAD] = (int16_t)border_position(x1, y1, dx, dy, right, bottom);
}

KERNEL void fit_line(const int32_t segments[], int32_t place, int16_t lines[], int32_t line, const uint8_t atan[],
                     int32_t width, int32_t height)
{
    int32_t base = place * SEGMENT_WORDS;
    int32_t edges = segments[base + EDGES];
    int32_t sum_x = segments[base + SUM_X];
    int32_t sum_y = segments[base + SUM_Y];
    int32_t xx = spread(segments[base + SUM_XX], sum_x, sum_x, edges);
    int32_t yy = spread(segments[base + SUM_YY], sum_y, sum_y, edges);
    int32_t xy = spread(segments[base + SUM_XY], sum_x, sum_y, edges);
    int32_t middle_x = floor_div(SUBPIXELS * sum_x + (edges >> 1), edges);
    int32_t middle_y = floor_div(SUBPIXELS * sum_y + (edges >> 1), edges);
    int32_t start_x = SUBPIXELS * segments[base + START_X] - middle_x;
    int32_t start_y = SUBPIXELS * segments[base + START_Y] - middle_y;
    int32_t end_x = SUBPIXELS * segments[base + END_X] - middle_x;
    int32_t end_y = SUBPIXELS * segments[base + END_Y] - middle_y;
    if (xx >= yy) {
        int32_t rise = slope(xx, xy);
        start_x = foot(start_x, start_y, rise);
        end_x = foot(end_x, end_y, rise);
        int32_t reach = start_x <= end_x ? HALF_PIXEL : -HALF_PIXEL;
        start_x = start_x - reach;
        start_y = start_x * rise >> SLOPE_BITS;
        end_x = end_x + reach;
        end_y = end_x * rise >> SLOPE_BITS;
    } else {
        int32_t rise = slope(yy, xy);
        start_y = foot(start_y, start_x, rise);
        end_y = foot(end_y, end_x, rise);
        int32_t reach = start_y <= end_y ? HALF_PIXEL : -HALF_PIXEL;
        start_y = start_y - reach;
        start_x = start_y * rise >> SLOPE_BITS;
        end_y = end_y + reach;
        end_x = end_y * rise >> SLOPE_BITS;
    }
    int32_t pixels = (max(abs(end_x - start_x), abs(end_y - start_y)) + HALF_PIXEL) >> 4;
    store_ends(lines, line, middle_x + start_x, middle_y + start_y, middle_x + end_x, middle_y + end_y, atan, width,
               height);
    lines[line * LINE_WORDS + LINE_EDGES] = (int16_t)edges;
    lines[line * LINE_WORDS + LINE_PROBABILITY] = (int16_t)min(floor_div(edges << 8, pixels), 255);
}
