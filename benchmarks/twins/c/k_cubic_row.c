/* A row at another scale by cubic interpolation, a function of four pixels and an 8-bit fraction. */
#include "ref.h"

#define SEED 1150u
#define N 200
#define SRC 128
#define STEP 150

HELPER int32_t cubic(int32_t a, int32_t b, int32_t c, int32_t d, int32_t t)
{
    int32_t c1 = c - a;
    int32_t c2 = 2 * a - 5 * b + 4 * c - d;
    int32_t c3 = 3 * (b - c) + d - a;
    int32_t v = ((c3 * t) >> 8) + c2;
    v = ((v * t) >> 8) + c1;
    v = ((v * t) >> 9) + b;
    return v < 0 ? 0 : v > 255 ? 255 : v;
}

KERNEL void cubic_row(const uint8_t src[], uint8_t dst[], int32_t n, int32_t step)
{
    int32_t pos = 256;
    for (int32_t i = 0; i < n; i++) {
        int32_t x = pos >> 8;
        dst[i] = (uint8_t)cubic(src[x - 1], src[x], src[x + 1], src[x + 2], pos & 255);
        pos += step;
    }
}

int main(void)
{
    static uint8_t src[SRC], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < SRC; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    cubic_row(src, dst, N, STEP);
    CYC_READ(c1);

    report("cubic_row", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAM("src", SRC);
    PARAM("step", STEP);
    PARAMS_END();
    return 0;
}
