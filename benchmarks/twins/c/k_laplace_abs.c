/* Absolute Laplacian of a picture, cut to a byte, and how many pixels were cut. */
#include "ref.h"

#define SEED 1245u
#define W 40
#define H 20

KERNEL int32_t laplace_abs(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h, int32_t gain)
{
    int32_t cut = 0;
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t p = y * w + x;
            int32_t d = 4 * src[p] - src[p - 1] - src[p + 1] - src[p - w] - src[p + w];
            if (d < 0) {
                d = -d;
            }
            d = d * gain;
            if (d > 255) {
                dst[p] = 255;
                cut++;
            } else {
                dst[p] = (uint8_t)d;
            }
        }
    }
    return cut;
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    int32_t cut;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    cut = laplace_abs(src, dst, W, H, 1);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    h = fnv_val32(h, (uint32_t)cut);
    report("laplace_abs", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
