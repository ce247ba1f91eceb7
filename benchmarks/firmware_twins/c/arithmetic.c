/* Twin of tinyphoon/arithmetic.py. */
#include "arithmetic.h"

KERNEL uint32_t isqrt32(uint32_t square)
{
    uint32_t root = 0;
    uint32_t bit = 1u << 30;
    uint32_t rest = square;
    for (int32_t i = 0; i < 16; i++) {
        uint32_t trial = root + bit;
        root = root >> 1;
        if (rest >= trial) {
            rest = rest - trial;
            root = root + bit;
        }
        bit = bit >> 2;
    }
    return root;
}

KERNEL int32_t angle8(int32_t x, int32_t y, const uint8_t atan[])
{
    int32_t ax = abs(x);
    int32_t ay = abs(y);
    int32_t angle;
    if (ax == 0 && ay == 0)
        return 0;
    if (ax >= ay)
        angle = atan[((uint32_t)ay << 8) / (uint32_t)ax];
    else
        angle = 64 - atan[((uint32_t)ax << 8) / (uint32_t)ay];
    if (x < 0)
        angle = 128 - angle;
    if (y < 0)
        angle = 256 - angle;
    return angle & 255;
}
