/* New levels of a tile by its histogram; what is above the limit goes to all. */
#include "ref.h"
#include <string.h>

#define SEED 3002u
#define W 48
#define H 32
#define LEVELS 64
#define LIMIT 20

KERNEL int32_t clahe_tile(const uint8_t *tile, int32_t stride, int32_t w, int32_t h, int32_t limit, uint8_t levels[LEVELS])
{
    uint16_t counts[LEVELS];
    int32_t cut = 0, total = 0;

    memset(counts, 0, sizeof counts);
    for (int32_t y = 0; y < h; y++, tile += stride)
        for (int32_t x = 0; x < w; x++)
            counts[tile[x] >> 2]++;

    for (int32_t i = 0; i < LEVELS; i++) {
        if (counts[i] > limit) {
            cut += counts[i] - limit;
            counts[i] = limit;
        }
    }
    int32_t share = cut / LEVELS, rest = cut % LEVELS;
    for (int32_t i = 0; i < LEVELS; i++)
        counts[i] += share;
    if (rest > 0) {
        int32_t step = LEVELS / rest;
        for (int32_t i = 0; i < LEVELS && rest > 0; i += step, rest--)
            counts[i]++;
    }

    for (int32_t i = 0; i < LEVELS; i++) {
        total += counts[i];
        int32_t level = 255 * total / (w * h);
        levels[i] = level > 255 ? 255 : level;
    }
    return cut;
}

int main(void)
{
    static uint8_t picture[H * W], levels[4][LEVELS];
    static int32_t cuts[4];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++) {
        picture[i] = 90 + lcg_below(&s, 20);
        picture[i] += lcg_below(&s, 20);
        if (i % W > 30)
            picture[i] += lcg_below(&s, 100);
    }

    CYC_READ(c0);
    for (int32_t i = 0; i < 4; i++) {
        const uint8_t *corner = picture + (i >> 1) * (H / 2) * W + (i & 1) * (W / 2);
        cuts[i] = clahe_tile(corner, W, W / 2, H / 2, LIMIT, levels[i]);
    }
    CYC_READ(c1);

    h = fnv_u8(h, levels[0], 4 * LEVELS);
    h = fnv_i32(h, cuts, 4);
    report("clahe_tile", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
