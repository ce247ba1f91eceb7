/* Smoothing by 1 4 6 4 1 along the rows, then along the columns. */
#include "ref.h"

#define SEED 1124u
#define W 32
#define H 20

KERNEL void separable5(const uint8_t src[], int16_t tmp[], uint8_t dst[], int32_t w, int32_t h)
{
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 2; x < w - 2; x++) {
            int32_t p = y * w + x;
            tmp[p] = (int16_t)(src[p - 2] + 4 * src[p - 1] + 6 * src[p] + 4 * src[p + 1] + src[p + 2]);
        }
    }
    for (int32_t y = 2; y < h - 2; y++) {
        for (int32_t x = 2; x < w - 2; x++) {
            int32_t p = y * w + x;
            int32_t sum = tmp[p - 2 * w] + tmp[p + 2 * w];
            sum += 4 * (tmp[p - w] + tmp[p + w]);
            sum += 6 * tmp[p];
            dst[p] = (uint8_t)((sum + 128) >> 8);
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    static int16_t tmp[W * H];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    separable5(src, tmp, dst, W, H);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    h = fnv_i16(h, tmp, W * H);
    report("separable5", c1 - c0, h);
    PARAMS(SEED, W*H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
