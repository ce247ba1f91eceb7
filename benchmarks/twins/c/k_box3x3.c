/* Mean of 3 x 3 pixels, by a product with 1/9. */
#include "ref.h"

#define SEED 1205u
#define W 40
#define H 24

KERNEL void box3x3(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h)
{
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t sum = 0;
            for (int32_t v = -1; v < 2; v++) {
                int32_t p = (y + v) * w + x;
                sum += src[p - 1] + src[p] + src[p + 1];
            }
            dst[y * w + x] = (uint8_t)((sum * 7282) >> 16);
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    box3x3(src, dst, W, H);
    CYC_READ(c1);

    report("box3x3", c1 - c0, fnv_u8(FNV_INIT, dst, W * H));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
