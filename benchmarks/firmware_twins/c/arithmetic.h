#ifndef ARITHMETIC_H
#define ARITHMETIC_H

#include "twin.h"

KERNEL uint32_t isqrt32(uint32_t square);
KERNEL int32_t angle8(int32_t x, int32_t y, const uint8_t atan[]);

#endif
