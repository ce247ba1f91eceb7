/* A Kalman filter of one state, 8 fractional bits; measurements beyond the gate are left out. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2831u
#define N 120

KERNEL int32_t kalman_track(const int16_t measured[], int32_t n, int32_t q, int32_t r, int32_t gate, int16_t out[])
{
    int32_t x = measured[0] << 8;
    int32_t p = r;
    int32_t skipped = 0;
    for (int32_t i = 0; i < n; i++) {
        p += q;
        if (p > 4 * r)
            p = 4 * r;
        int32_t innovation = (measured[i] << 8) - x;
        if (abs(innovation) > gate) {
            skipped++;
        } else {
            int32_t k = (p << 12) / (p + r);
            x += (k * innovation) >> 12;
            p -= (k * p) >> 12;
        }
        out[i] = x >> 8;
    }
    return skipped;
}

int main(void)
{
    static int16_t measured[N], out[N];
    int32_t skipped;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        if (lcg_below(&s, 10))
            measured[i] = (int16_t)(100 + i + lcg_below(&s, 20));
        else
            measured[i] = (int16_t)lcg_below(&s, 500);
    }

    CYC_READ(c0);
    skipped = kalman_track(measured, N, 40, 2000, 10000, out);
    CYC_READ(c1);

    h = fnv_i16(h, out, N);
    h = fnv_val32(h, (uint32_t)skipped);
    report("kalman_track", c1 - c0, h);
    PARAMS(SEED, N, "measurement");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
