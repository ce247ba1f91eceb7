/* The next exposure by every fourth pixel of 4 x 4 zones. */
#include "ref.h"

#define SEED 2913u
#define W 96
#define H 48
#define FRAMES 4

KERNEL int32_t meter_exposure(const uint8_t *image, int32_t w, int32_t h, const uint8_t weights[16], uint8_t means[16],
                              int32_t exposure)
{
    int32_t zone_w = w / 4, zone_h = h / 4;
    int32_t light = 0, weight = 0, bright = 0;
    for (int32_t zone = 0; zone < 16; zone++) {
        const uint8_t *corner = image + zone / 4 * zone_h * w + zone % 4 * zone_w;
        int32_t total = 0;
        for (int32_t y = 0; y < zone_h; y += 2) {
            const uint8_t *row = corner + y * w;
            for (int32_t x = 0; x < zone_w; x += 2) {
                total += row[x];
                if (row[x] >= 250)
                    bright++;
            }
        }
        int32_t mean = 4 * total / (zone_w * zone_h);
        means[zone] = mean;
        light += weights[zone] * mean;
        weight += weights[zone];
    }
    if (100 * bright > w * h)
        return exposure - (exposure >> 3);
    int32_t level = light / weight;
    if (level < 1)
        level = 1;
    int32_t wanted = 110 * exposure / level;
    if (wanted < exposure / 2)
        return exposure / 2;
    if (wanted > 2 * exposure)
        return 2 * exposure;
    return wanted;
}

int main(void)
{
    static const uint8_t weights[16] = {1, 2, 2, 1, 2, 6, 6, 2, 3, 8, 8, 3, 2, 4, 4, 2};
    static uint8_t images[FRAMES][W * H], means[16];
    int32_t exposures[FRAMES], exposure = 900;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t f = 0; f < FRAMES; f++)
        for (int32_t i = 0; i < W * H; i++)
            images[f][i] = (uint8_t)lcg_below(&s, 100 + 52 * f);

    CYC_READ(c0);
    for (int32_t f = 0; f < FRAMES; f++) {
        exposure = meter_exposure(images[f], W, H, weights, means, exposure);
        exposures[f] = exposure;
    }
    CYC_READ(c1);

    h = fnv_u8(h, means, 16);
    h = fnv_i32(h, exposures, FRAMES);
    report("meter_exposure", c1 - c0, h);
    PARAMS(SEED, FRAMES * W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
