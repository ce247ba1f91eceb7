/* The inverse of 3 x 3, 12 fractional bits; 0 if it is nearly singular. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2834u
#define MATRICES 16

KERNEL int32_t invert_matrix(const int32_t m[9], int32_t out[9])
{
    int32_t c0 = (m[4] * m[8] - m[5] * m[7]) >> 12;
    int32_t c1 = (m[5] * m[6] - m[3] * m[8]) >> 12;
    int32_t c2 = (m[3] * m[7] - m[4] * m[6]) >> 12;
    int32_t determinant = (m[0] * c0 + m[1] * c1 + m[2] * c2) >> 12;
    if (abs(determinant) < 1024)
        return 0;
    int32_t scale = (1 << 24) / determinant;
    out[0] = (c0 * scale) >> 12;
    out[1] = (((m[2] * m[7] - m[1] * m[8]) >> 12) * scale) >> 12;
    out[2] = (((m[1] * m[5] - m[2] * m[4]) >> 12) * scale) >> 12;
    out[3] = (c1 * scale) >> 12;
    out[4] = (((m[0] * m[8] - m[2] * m[6]) >> 12) * scale) >> 12;
    out[5] = (((m[2] * m[3] - m[0] * m[5]) >> 12) * scale) >> 12;
    out[6] = (c2 * scale) >> 12;
    out[7] = (((m[1] * m[6] - m[0] * m[7]) >> 12) * scale) >> 12;
    out[8] = (((m[0] * m[4] - m[1] * m[3]) >> 12) * scale) >> 12;
    return 1;
}

int main(void)
{
    static int32_t m[9 * MATRICES], out[9 * MATRICES];
    int32_t done[MATRICES];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 9 * MATRICES; i++)
        m[i] = lcg_below(&s, 10000) - 5000;

    CYC_READ(c0);
    for (int32_t i = 0; i < MATRICES; i++)
        done[i] = invert_matrix(m + 9 * i, out + 9 * i);
    CYC_READ(c1);

    h = fnv_i32(h, out, 9 * MATRICES);
    h = fnv_i32(h, done, MATRICES);
    report("invert_matrix", c1 - c0, h);
    PARAMS(SEED, MATRICES, "matrix");
    PARAM("matrices", MATRICES);
    PARAMS_END();
    return 0;
}
