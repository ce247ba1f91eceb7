/* Twin of tinyphoon/stages/line_detection.py: `fit_lines`. */
#include "line_fit.h"

KERNEL void fit_lines(const int32_t segments[], int32_t count, int16_t lines[], const uint8_t atan[], int32_t width,
                      int32_t height)
{
    for (int32_t place = 0; place < count; place++)
        fit_line(segments, place, lines, place, atan, width, height);
}
