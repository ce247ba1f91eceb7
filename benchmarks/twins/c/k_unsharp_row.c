/* Unsharp mask by a 1-4-6-4-1 smoothing along a row, cut to bytes. */
#include "ref.h"

#define SEED 1502u
#define N 240

KERNEL void unsharp_row(const uint8_t src[], uint8_t dst[], int32_t n, int32_t gain)
{
    for (int32_t x = 2; x < n - 2; x++) {
        int32_t smooth = (src[x - 2] + 4 * src[x - 1] + 6 * src[x] + 4 * src[x + 1] + src[x + 2]) >> 4;
        int32_t v = src[x] + (((src[x] - smooth) * gain) >> 4);
        if (v < 0) {
            v = 0;
        } else if (v > 255) {
            v = 255;
        }
        dst[x] = (uint8_t)v;
    }
}

int main(void)
{
    static uint8_t src[N], dst[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    unsharp_row(src, dst, N, 20);
    CYC_READ(c1);

    h = fnv_u8(h, dst, N);
    report("unsharp_row", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
