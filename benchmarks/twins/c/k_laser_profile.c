/* Where each column is brightest, in 16ths of a row; -1 where it is dark. */
#include "ref.h"

#define SEED 2814u
#define W 64
#define H 48

KERNEL void laser_profile(const uint8_t *image, int32_t w, int32_t h, int32_t threshold, int16_t *out)
{
    for (int32_t x = 0; x < w; x++) {
        int32_t best = 0, at = 0;
        for (int32_t y = 0; y < h; y++) {
            int32_t v = image[y * w + x];
            if (v > best) {
                best = v;
                at = y;
            }
        }
        if (best < threshold) {
            out[x] = -1;
            continue;
        }
        int32_t first = at - 3 < 0 ? 0 : at - 3;
        int32_t end = at + 4 > h ? h : at + 4;
        int32_t total = 0, moment = 0;
        for (int32_t y = first; y < end; y++) {
            int32_t v = image[y * w + x];
            total += v;
            moment += v * y;
        }
        out[x] = (16 * moment + total / 2) / total;
    }
}

int main(void)
{
    static uint8_t image[W * H];
    static int16_t out[W];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = (uint8_t)lcg_below(&s, 50);
    for (int32_t x = 0; x < W; x++) {
        if (x % 16 != 5) {
            for (int32_t k = -2; k <= 2; k++)
                image[(20 + x / 4 + k) * W + x] += 160 - 50 * (k < 0 ? -k : k);
        }
    }

    CYC_READ(c0);
    laser_profile(image, W, H, 120, out);
    CYC_READ(c1);

    report("laser_profile", c1 - c0, fnv_i16(FNV_INIT, out, W));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
