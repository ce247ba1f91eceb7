/* Colours of a row of red and green pixels, the first is red. */
#include "ref.h"

#define SEED 2812u
#define W 320

KERNEL void demosaic_row(const uint8_t *above, const uint8_t *here, const uint8_t *below, uint8_t *out, int32_t w)
{
    out += 3;
    for (int32_t x = 1; x < w - 2; x += 2) {
        *out++ = (here[x - 1] + here[x + 1]) >> 1;
        *out++ = here[x];
        *out++ = (above[x] + below[x]) >> 1;
        *out++ = here[x + 1];
        *out++ = (here[x] + here[x + 2] + above[x + 1] + below[x + 1]) >> 2;
        *out++ = (above[x] + above[x + 2] + below[x] + below[x + 2]) >> 2;
    }
}

int main(void)
{
    static uint8_t above[W], here[W], below[W], out[3 * W];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W; i++)
        above[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < W; i++)
        here[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < W; i++)
        below[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    demosaic_row(above, here, below, out, W);
    CYC_READ(c1);

    report("demosaic_row", c1 - c0, fnv_u8(FNV_INIT, out, 3 * W));
    PARAMS(SEED, W, "pixel");
    PARAM("w", W);
    PARAMS_END();
    return 0;
}
