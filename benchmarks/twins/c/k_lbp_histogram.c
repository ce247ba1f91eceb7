/* Local binary patterns: which of eight neighbours are as bright as a pixel. */
#include "ref.h"

#define SEED 2802u
#define W 48
#define H 32
#define BINS 59

KERNEL void lbp_histogram(const uint8_t *image, int32_t w, int32_t h, const uint8_t bin_of[256], uint16_t counts[])
{
    for (int32_t y = 1; y < h - 1; y++) {
        const uint8_t *up = image + (y - 1) * w;
        const uint8_t *here = up + w;
        const uint8_t *down = here + w;
        for (int32_t x = 1; x < w - 1; x++) {
            uint8_t centre = here[x];
            uint32_t code = 0;
            if (up[x - 1] >= centre)
                code |= 1;
            if (up[x] >= centre)
                code |= 2;
            if (up[x + 1] >= centre)
                code |= 4;
            if (here[x + 1] >= centre)
                code |= 8;
            if (down[x + 1] >= centre)
                code |= 16;
            if (down[x] >= centre)
                code |= 32;
            if (down[x - 1] >= centre)
                code |= 64;
            if (here[x - 1] >= centre)
                code |= 128;
            counts[bin_of[code]]++;
        }
    }
}

int main(void)
{
    static uint8_t image[W * H], bin_of[256];
    static uint16_t counts[BINS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = (uint8_t)lcg_below(&s, 64);
    for (int32_t i = 0; i < 256; i++)
        bin_of[i] = (uint8_t)lcg_below(&s, BINS);

    CYC_READ(c0);
    lbp_histogram(image, W, H, bin_of, counts);
    CYC_READ(c1);

    report("lbp_histogram", c1 - c0, fnv_u16(FNV_INIT, counts, BINS));
    PARAMS(SEED, (W - 2) * (H - 2), "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
