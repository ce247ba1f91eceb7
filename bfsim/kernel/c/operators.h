/* operators.h - what the kernel language of bfsim has and C has not, or leaves open.
 *
 * Kernels compute with 32 bits that wrap: compile them with -fwrapv.
 */
#ifndef OPERATORS_H
#define OPERATORS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* An operator is no call, so it is never one here. */
#if defined __GNUC__
#define OPERATOR static inline __attribute__((always_inline, unused))
#else
#define OPERATOR static inline
#endif

OPERATOR int32_t min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

OPERATOR int32_t max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

OPERATOR uint32_t min_u32(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

OPERATOR uint32_t max_u32(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* The first of two when neither is smaller, or when one is no number. */
OPERATOR float min_f32(float a, float b)
{
    return b < a ? b : a;
}

OPERATOR float max_f32(float a, float b)
{
    return b > a ? b : a;
}

/* a // b, rounded down. C rounds towards zero. */
OPERATOR int32_t floor_div(int32_t a, int32_t b)
{
    int32_t quotient = a / b;
    if ((a ^ b) < 0 && quotient * b != a)
        quotient--;
    return quotient;
}

/* a % b, with the sign of b. In C it has that of a. */
OPERATOR int32_t floor_mod(int32_t a, int32_t b)
{
    int32_t remainder = a % b;
    if (remainder != 0 && (remainder ^ b) < 0)
        remainder += b;
    return remainder;
}

/* Towards zero; what does not fit becomes the nearest that does, and no number becomes 0. */
OPERATOR int32_t to_i32(float a)
{
    if (a >= 2147483648.0f)
        return INT32_MAX;
    if (a < -2147483648.0f)
        return INT32_MIN;
    return a == a ? (int32_t)a : 0;
}

OPERATOR uint32_t to_u32(float a)
{
    if (a >= 4294967296.0f)
        return UINT32_MAX;
    return a > 0.0f ? (uint32_t)a : 0;
}

#endif
