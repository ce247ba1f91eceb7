/* One generation of the game of life; the border stays dead. */
#include "ref.h"

#define SEED 1402u
#define W 24
#define H 20

KERNEL int32_t life_step(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h)
{
    int32_t alive = 0;
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t p = y * w + x;
            int32_t n = src[p - w - 1] + src[p - w] + src[p - w + 1] + src[p - 1] + src[p + 1]
                        + src[p + w - 1] + src[p + w] + src[p + w + 1];
            if (n == 3 || (n == 2 && src[p] != 0)) {
                dst[p] = 1;
                alive++;
            } else {
                dst[p] = 0;
            }
        }
    }
    return alive;
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    int32_t alive;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = lcg_u8(&s) < 90;

    CYC_READ(c0);
    alive = life_step(src, dst, W, H);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    h = fnv_val32(h, (uint32_t)alive);
    report("life_step", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
