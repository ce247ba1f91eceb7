/* Minimum of each 3 x 3 neighbourhood. */
#include "ref.h"

#define SEED 1309u
#define W 32
#define H 20

KERNEL void erode3x3(const uint8_t src[], int32_t w, int32_t h, uint8_t dst[])
{
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t least = 255;
            for (int32_t dy = -1; dy < 2; dy++) {
                for (int32_t dx = -1; dx < 2; dx++) {
                    int32_t v = src[(y + dy) * w + x + dx];
                    if (v < least) {
                        least = v;
                    }
                }
            }
            dst[y * w + x] = (uint8_t)least;
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    erode3x3(src, W, H, dst);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    report("erode3x3", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
