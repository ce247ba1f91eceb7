/* Pixels of 16 bits, with an ordered dither of 4 x 4. */
#include "ref.h"

#define SEED 2815u
#define W 160
#define H 4

KERNEL void dither_565(const uint8_t *rgb, const uint8_t pattern[16], int32_t w, int32_t y, uint16_t *out)
{
    const uint8_t *row = pattern + 4 * (y & 3);
    for (int32_t x = 0; x < w; x++) {
        int32_t t = row[x & 3];
        int32_t r = rgb[3 * x] + (t >> 1);
        int32_t g = rgb[3 * x + 1] + (t >> 2);
        int32_t b = rgb[3 * x + 2] + (t >> 1);
        if (r > 255)
            r = 255;
        if (g > 255)
            g = 255;
        if (b > 255)
            b = 255;
        out[x] = ((r >> 3) << 11) | ((g >> 2) << 5) | (b >> 3);
    }
}

int main(void)
{
    static const uint8_t pattern[16] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    static uint8_t rgb[3 * W * H];
    static uint16_t out[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < 3 * W * H; i++)
        rgb[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    for (int32_t y = 0; y < H; y++)
        dither_565(rgb + 3 * W * y, pattern, W, y, out + W * y);
    CYC_READ(c1);

    report("dither_565", c1 - c0, fnv_u16(FNV_INIT, out, W * H));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAMS_END();
    return 0;
}
