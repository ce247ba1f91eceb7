/* A table for contrast and brightness, cut to a byte, and an image through it; counts the pixels that are cut. */
#include "ref.h"

#define SEED 1409u
#define N 600

KERNEL int32_t contrast_lut(uint8_t image[], int32_t n, int32_t gain, int32_t offset, uint8_t lut[])
{
    for (int32_t i = 0; i < 256; i++) {
        int32_t v = (((i - 128) * gain) >> 6) + 128 + offset;
        if (v < 0) {
            v = 0;
        }
        if (v > 255) {
            v = 255;
        }
        lut[i] = (uint8_t)v;
    }
    int32_t cut = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t v = lut[image[i]];
        if (v == 0 || v == 255) {
            cut++;
        }
        image[i] = (uint8_t)v;
    }
    return cut;
}

int main(void)
{
    static uint8_t image[N], lut[256];
    int32_t cut;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        image[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    cut = contrast_lut(image, N, 96, 10, lut);
    CYC_READ(c1);

    h = fnv_u8(h, image, N);
    h = fnv_val32(h, (uint32_t)cut);
    report("contrast_lut", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
