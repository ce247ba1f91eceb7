#ifndef LINE_FIT_H
#define LINE_FIT_H

#include "twin.h"

#define SLOPE_BITS 12

KERNEL int32_t spread(int32_t products, int32_t sum_a, int32_t sum_b, int32_t edges);
KERNEL int32_t slope(int32_t along, int32_t across);
KERNEL void store_ends(int16_t lines[], int32_t line, int32_t x0, int32_t y0, int32_t x1, int32_t y1,
                       const uint8_t atan[], int32_t width, int32_t height);
KERNEL void fit_line(const int32_t segments[], int32_t place, int16_t lines[], int32_t line, const uint8_t atan[],
                     int32_t width, int32_t height);

#endif
