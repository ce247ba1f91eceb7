/* Twin of tinyphoon/stages/line_refinement.py: `look_at_row`. */
#include "line_fit.h"
#include "lines.h"

/* words of the sums of a line, which lie over its segment */
#define SEGMENT_WORDS 13
#define FIRST_ROW 0
#define LAST_ROW 1
#define MIDDLE_ROW 2
#define BRIGHTENS 3
#define RISE 4
#define ROWS 5
#define SUM_OFF 6
#define SUM_DOWN 7
#define SUM_OFF_DOWN 8
#define SUM_DOWN_DOWN 9

#define STEPS 128

HELPER int32_t line_column(const int16_t lines[], int32_t line, int32_t rise, int32_t row)
{
    int32_t at = line * LINE_WORDS;
    return lines[at + LINE_X0] + (rise * (SUBPIXELS * row - lines[at + LINE_Y0]) >> SLOPE_BITS);
}

KERNEL void look_at_row(const uint8_t uyvy[], int32_t y, const int16_t lines[], int32_t count, int32_t sums[],
                        int32_t reach, int32_t min_step, int32_t uyvy_length)
{
    int32_t width = uyvy_length >> 1;
    for (int32_t line = 0; line < count; line++) {
        int32_t base = line * SEGMENT_WORDS;
        if (sums[base + FIRST_ROW] <= y && y <= sums[base + LAST_ROW]) {
            int32_t column = line_column(lines, line, sums[base + RISE], y);
            int32_t middle = (column + SUBPIXELS / 2) >> 4;
            int32_t steps = 0;
            int32_t moment = 0;
            int32_t stop = min(middle + reach, width - 2) + 1;
            for (int32_t x = max(middle - reach, 1); x < stop; x++) {
                int32_t step = sums[base + BRIGHTENS] * (uyvy[2 * x + 3] - uyvy[2 * x - 1]);
                if (step >= min_step) {
                    steps = steps + step;
                    moment = moment + step * (SUBPIXELS * x - column);
                }
            }
            if (steps > 0) {
                int32_t off = floor_div(moment * (STEPS / SUBPIXELS) + (steps >> 1), steps);
                int32_t down = y - sums[base + MIDDLE_ROW];
                sums[base + ROWS] = sums[base + ROWS] + 1;
                sums[base + SUM_OFF] = sums[base + SUM_OFF] + off;
                sums[base + SUM_DOWN] = sums[base + SUM_DOWN] + down;
                sums[base + SUM_OFF_DOWN] = sums[base + SUM_OFF_DOWN] + off * down;
                sums[base + SUM_DOWN_DOWN] = sums[base + SUM_DOWN_DOWN] + down * down;
            }
        }
    }
}
