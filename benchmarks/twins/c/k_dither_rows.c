/* Floyd-Steinberg dithering to black and white. */
#include "ref.h"

#define SEED 1406u
#define W 32
#define H 12

KERNEL void dither_rows(int16_t grey[], int32_t w, int32_t h, uint8_t out[])
{
    for (int32_t y = 0; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t p = y * w + x;
            int32_t v = grey[p];
            int32_t e = v;
            out[p] = 0;
            if (v > 127) {
                out[p] = 255;
                e = v - 255;
            }
            grey[p + 1] = (int16_t)(grey[p + 1] + ((e * 7) >> 4));
            grey[p + w - 1] = (int16_t)(grey[p + w - 1] + ((e * 3) >> 4));
            grey[p + w] = (int16_t)(grey[p + w] + ((e * 5) >> 4));
            grey[p + w + 1] = (int16_t)(grey[p + w + 1] + (e >> 4));
        }
    }
}

int main(void)
{
    static int16_t grey[W * H];
    static uint8_t out[W * H];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        grey[i] = (int16_t)lcg_u8(&s);

    CYC_READ(c0);
    dither_rows(grey, W, H, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, W * H);
    report("dither_rows", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
