/* Histogram, its prefix sums, and the first level at which each of several shares is reached. */
#include "ref.h"

#define SEED 1311u
#define N 800
#define SHARES 9

KERNEL void percentiles(const uint8_t src[], int32_t n, int32_t hist[], const uint8_t shares[], int32_t m, uint8_t level[])
{
    for (int32_t i = 0; i < 64; i++) {
        hist[i] = 0;
    }
    for (int32_t i = 0; i < n; i++) {
        hist[src[i] >> 2] += 1;
    }
    for (int32_t i = 1; i < 64; i++) {
        hist[i] += hist[i - 1];
    }
    for (int32_t k = 0; k < m; k++) {
        int32_t wanted = n * shares[k];
        int32_t v = 0;
        while (hist[v] * 100 < wanted) {
            v++;
        }
        level[k] = (uint8_t)(4 * v);
    }
}

int main(void)
{
    static uint8_t src[N], shares[SHARES], level[SHARES];
    static int32_t hist[64];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < SHARES; i++)
        shares[i] = (uint8_t)(10 * (i + 1));

    CYC_READ(c0);
    percentiles(src, N, hist, shares, SHARES, level);
    CYC_READ(c1);

    h = fnv_i32(h, hist, 64);
    h = fnv_u8(h, level, SHARES);
    report("percentiles", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAM("shares", SHARES);
    PARAMS_END();
    return 0;
}
