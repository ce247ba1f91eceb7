/* Half size in both directions: the rounded mean of 2 x 2 pixels. */
#include "ref.h"

#define SEED 1129u
#define W 64
#define H 48

KERNEL void downsample2(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h)
{
    int32_t k = 0;
    for (int32_t y = 0; y < h; y += 2) {
        for (int32_t x = 0; x < w; x += 2) {
            int32_t p = y * w + x;
            dst[k] = (uint8_t)((src[p] + src[p + 1] + src[p + w] + src[p + w + 1] + 2) >> 2);
            k++;
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H / 4];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    downsample2(src, dst, W, H);
    CYC_READ(c1);

    report("downsample2", c1 - c0, fnv_u8(FNV_INIT, dst, W * H / 4));
    PARAMS(SEED, W*H/4, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
