/* twin.h - what every C twin of the firmware's kernels needs.
 *
 * One Python kernel is one C function with the same statements in the same order. A length that the kernel asks for
 * is one more parameter, after the others. KERNEL stands before a function that other files or the harness call,
 * HELPER before one that only its own file calls. What the two mean is for the measuring script to say:
 *   calls     every function is called (noinline, noclone)
 *   inlined   helpers are static: GCC may inline and clone within a file; a call into another file is a call
 *   one_file  everything is static in one file
 */
#ifndef TWIN_H
#define TWIN_H

#include <stdint.h>
#include <stdlib.h>

#ifndef KERNEL
#define KERNEL
#endif
#ifndef HELPER
#define HELPER static
#endif

/* An operator of Python that C has not: it is no call there, so it is never one here. */
#define OPERATOR static inline __attribute__((always_inline, unused))

OPERATOR int32_t min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

OPERATOR int32_t max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* a // b, rounded down */
OPERATOR int32_t floor_div(int32_t a, int32_t b)
{
    int32_t quotient = a / b;
    if ((a ^ b) < 0 && quotient * b != a)
        quotient--;
    return quotient;
}

/* a % b, with the sign of b */
OPERATOR int32_t floor_mod(int32_t a, int32_t b)
{
    int32_t remainder = a % b;
    if (remainder != 0 && (remainder ^ b) < 0)
        remainder += b;
    return remainder;
}

#endif
