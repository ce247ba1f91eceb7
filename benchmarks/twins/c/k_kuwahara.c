/* Of the four windows of 3 x 3 with a pixel in their corner, the mean of the one that varies least. */
#include "ref.h"

#define SEED 3001u
#define W 32
#define H 16

KERNEL void kuwahara(const uint8_t *picture, int32_t w, int32_t h, uint8_t *out)
{
    const int32_t corners[4] = {0, -2, -2 * w, -2 * w - 2};

    for (int32_t y = 2; y < h - 2; y++) {
        const uint8_t *here = picture + y * w + 2;
        uint8_t *to = out + y * w + 2;
        for (int32_t x = 2; x < w - 2; x++, here++) {
            uint32_t least = UINT32_MAX, calmest = 0;
            for (int32_t quadrant = 0; quadrant < 4; quadrant++) {
                const uint8_t *row = here + corners[quadrant];
                uint32_t total = 0, squares = 0;
                for (int32_t v = 0; v < 3; v++, row += w) {
                    for (int32_t u = 0; u < 3; u++) {
                        uint32_t p = row[u];
                        total += p;
                        squares += p * p;
                    }
                }
                uint32_t spread = 9 * squares - total * total;
                if (spread < least) {
                    least = spread;
                    calmest = total;
                }
            }
            *to++ = (calmest + 4) / 9;
        }
    }
}

int main(void)
{
    static uint8_t picture[H][W], out[H][W];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++)
            picture[y][x] = (x < 13 + y / 2 ? 60 : 150) + lcg_below(&s, 50);

    CYC_READ(c0);
    kuwahara(picture[0], W, H, out[0]);
    CYC_READ(c1);

    h = fnv_u8(h, out[0], W * H);
    report("kuwahara", c1 - c0, h);
    PARAMS(SEED, (W - 4) * (H - 4), "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
