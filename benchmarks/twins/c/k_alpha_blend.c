/* Blend a foreground over an image by 8-bit opacity; nothing to do where it is clear. */
#include "ref.h"

#define SEED 1128u
#define N 800

KERNEL void alpha_blend(const uint8_t fore[], const uint8_t alpha[], uint8_t image[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t a = alpha[i];
        if (a == 0) {
            continue;
        }
        if (a == 255) {
            image[i] = fore[i];
            continue;
        }
        int32_t t = fore[i] * a + image[i] * (255 - a) + 128;
        image[i] = (uint8_t)((t + (t >> 8)) >> 8);
    }
}

int main(void)
{
    static uint8_t fore[N], alpha[N], image[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        fore[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        image[i] = (uint8_t)lcg_u8(&s);
    /* a byte below 80 is clear, one above 200 opaque */
    for (int32_t i = 0; i < N; i++) {
        int32_t a = lcg_u8(&s);
        alpha[i] = (uint8_t)(a < 80 ? 0 : a > 200 ? 255 : a);
    }

    CYC_READ(c0);
    alpha_blend(fore, alpha, image, N);
    CYC_READ(c1);

    report("alpha_blend", c1 - c0, fnv_u8(FNV_INIT, image, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
