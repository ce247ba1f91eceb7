/* Bilinear interpolation of one row at 8.8 source positions. */
#include "ref.h"

#define SEED 1107u
#define N 320
#define W 64
#define H 48

KERNEL void bilinear_row(const uint8_t src[], int32_t w, const uint16_t xs[], const uint16_t ys[],
                         uint8_t dst[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t fx = xs[i] & 255;
        int32_t fy = ys[i] & 255;
        int32_t p = (ys[i] >> 8) * w + (xs[i] >> 8);
        int32_t top = src[p] * (256 - fx) + src[p + 1] * fx;
        int32_t bottom = src[p + w] * (256 - fx) + src[p + w + 1] * fx;
        dst[i] = (uint8_t)((top * (256 - fy) + bottom * fy + 32768) >> 16);
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[N];
    static uint16_t xs[N], ys[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);
    /* positions from 0 to just before the last column and row */
    for (int32_t i = 0; i < N; i++)
        xs[i] = (uint16_t)lcg_below(&s, (W - 1) * 256);
    for (int32_t i = 0; i < N; i++)
        ys[i] = (uint16_t)lcg_below(&s, (H - 1) * 256);

    CYC_READ(c0);
    bilinear_row(src, W, xs, ys, dst, N);
    CYC_READ(c1);

    report("bilinear_row", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
