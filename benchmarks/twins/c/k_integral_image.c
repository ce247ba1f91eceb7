/* Integral image with a row and a column of zeros in front. */
#include "ref.h"

#define SEED 1126u
#define W 32
#define H 24

KERNEL void integral_image(const uint8_t src[], uint32_t out[], int32_t w, int32_t h)
{
    int32_t stride = w + 1;
    for (int32_t x = 0; x < stride; x++) {
        out[x] = 0;
    }
    for (int32_t y = 0; y < h; y++) {
        uint32_t row = 0;
        int32_t to = (y + 1) * stride;
        out[to] = 0;
        for (int32_t x = 0; x < w; x++) {
            row += src[y * w + x];
            out[to + x + 1] = out[to + x + 1 - stride] + row;
        }
    }
}

int main(void)
{
    static uint8_t src[W * H];
    static uint32_t out[(W + 1) * (H + 1)];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    integral_image(src, out, W, H);
    CYC_READ(c1);

    report("integral_image", c1 - c0, fnv_u32(FNV_INIT, out, (W + 1) * (H + 1)));
    PARAMS(SEED, W*H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
