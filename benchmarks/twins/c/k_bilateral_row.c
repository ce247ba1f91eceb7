/* Smooth over 7 pixels with those that are alike; the three at either end stay. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2904u
#define N 320

KERNEL void bilateral_row(const uint8_t *row, int32_t n, const uint8_t near[7], const uint8_t alike[256], uint8_t *out)
{
    for (int32_t x = 0; x < 3; x++) {
        out[x] = row[x];
        out[n - 1 - x] = row[n - 1 - x];
    }
    for (int32_t x = 3; x < n - 3; x++) {
        int32_t here = row[x];
        int32_t total = 0, weights = 0;
        for (int32_t k = -3; k <= 3; k++) {
            int32_t v = row[x + k];
            int32_t weight = near[k + 3] * alike[abs(v - here)];
            weights += weight;
            total += weight * v;
        }
        out[x] = (total + weights / 2) / weights;
    }
}

int main(void)
{
    static const uint8_t near[7] = {2, 8, 14, 16, 14, 8, 2};
    static uint8_t row[N], out[N], alike[256];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t d = 0; d < 256; d++)
        alike[d] = 255 - 6 * d > 0 ? 255 - 6 * d : 0;
    for (int32_t x = 0; x < N; x++)
        row[x] = (uint8_t)((x >> 5 & 1 ? 60 : 170) + lcg_below(&s, 30));

    CYC_READ(c0);
    bilateral_row(row, N, near, alike, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, N);
    report("bilateral_row", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
