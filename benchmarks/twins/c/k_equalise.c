/* Histogram equalisation: histogram, cumulated histogram as a table, look-up. */
#include "ref.h"

#define SEED 1103u
#define N 1024

KERNEL void equalise(const uint8_t src[], uint8_t dst[], uint16_t hist[], uint8_t lut[], int32_t n)
{
    uint32_t sum = 0;
    for (int32_t i = 0; i < 256; i++) {
        hist[i] = 0;
    }
    for (int32_t i = 0; i < n; i++) {
        hist[src[i]] = (uint16_t)(hist[src[i]] + 1);
    }
    for (int32_t i = 0; i < 256; i++) {
        sum += (uint32_t)hist[i];
        lut[i] = (uint8_t)(sum * 255u / (uint32_t)n);
    }
    for (int32_t i = 0; i < n; i++) {
        dst[i] = lut[src[i]];
    }
}

int main(void)
{
    static uint8_t src[N], dst[N], lut[256];
    static uint16_t hist[256];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* 30 .. 157 */
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)(30 + lcg_below(&s, 128));

    CYC_READ(c0);
    equalise(src, dst, hist, lut, N);
    CYC_READ(c1);

    h = fnv_u8(h, dst, N);
    h = fnv_u16(h, hist, 256);
    report("equalise", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
