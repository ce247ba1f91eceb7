#ifndef GEOMETRY_H
#define GEOMETRY_H

#include "twin.h"

KERNEL int32_t depth_mm(const int32_t geometry[], int32_t disparity);
KERNEL int32_t beside_mm(const int32_t geometry[], int32_t depth, int32_t off_axis);
KERNEL int32_t store_point(const int32_t geometry[], int32_t x, int32_t y, int32_t disparity, int32_t width,
                           int32_t height, int16_t words[], int32_t at);

#endif
