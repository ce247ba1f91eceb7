/* Image of half the size: averages of 2 x 2 pixels, rounded. */
#include "ref.h"

#define SEED 1403u
#define W 20
#define H 14

KERNEL void halve_image(const uint8_t src[], int32_t w, int32_t h, uint8_t dst[])
{
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            int32_t sum = 2;
            for (int32_t dy = 0; dy < 2; dy++) {
                for (int32_t dx = 0; dx < 2; dx++) {
                    sum += src[(2 * y + dy) * 2 * w + 2 * x + dx];
                }
            }
            dst[y * w + x] = (uint8_t)(sum >> 2);
        }
    }
}

int main(void)
{
    static uint8_t src[4 * W * H], dst[W * H];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 4 * W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    halve_image(src, W, H, dst);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    report("halve_image", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
