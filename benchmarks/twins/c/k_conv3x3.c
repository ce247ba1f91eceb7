/* 3 x 3 convolution of a w x h image with a coefficient array, clamped to 0..255. */
#include "ref.h"

#define SEED 1125u
#define W 24
#define H 20
#define SHIFT 4

KERNEL void conv3x3(const uint8_t src[], const int16_t coef[], uint8_t dst[], int32_t w, int32_t h,
                    int32_t shift)
{
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t sum = 0;
            for (int32_t ky = 0; ky < 3; ky++) {
                for (int32_t kx = 0; kx < 3; kx++) {
                    sum += coef[ky * 3 + kx] * src[(y + ky - 1) * w + x + kx - 1];
                }
            }
            sum = sum >> shift;
            if (sum < 0) {
                sum = 0;
            }
            if (sum > 255) {
                sum = 255;
            }
            dst[y * w + x] = (uint8_t)sum;
        }
    }
}

int main(void)
{
    static const int16_t coef[9] = {-1, -2, -1, -2, 28, -2, -1, -2, -1};
    static uint8_t src[W * H], dst[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    conv3x3(src, coef, dst, W, H, SHIFT);
    CYC_READ(c1);

    report("conv3x3", c1 - c0, fnv_u8(FNV_INIT, dst, W * H));
    PARAMS(SEED, (W-2)*(H-2), "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("shift", SHIFT);
    PARAMS_END();
    return 0;
}
