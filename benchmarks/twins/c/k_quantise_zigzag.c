/* Quantised coefficients of 8 x 8 as pairs: zeros before it, value; -1 ends them. */
#include "ref.h"

#define SEED 2821u
#define BLOCKS 4
#define MOST 129

KERNEL int32_t quantise_zigzag(const int16_t block[64], const uint16_t reciprocals[64], const uint8_t order[64], int16_t *out)
{
    int16_t *start = out;
    int32_t run = 0;
    for (int32_t i = 0; i < 64; i++) {
        int32_t p = order[i];
        int32_t c = block[p], q;
        if (c < 0)
            q = -((-c * reciprocals[p] + 32768) >> 16);
        else
            q = (c * reciprocals[p] + 32768) >> 16;
        if (q == 0) {
            run++;
        } else {
            *out++ = run;
            *out++ = q;
            run = 0;
        }
    }
    *out++ = -1;
    return out - start;
}

int main(void)
{
    static const uint8_t order[64] = {
        0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
        41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
        30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63,
    };
    static uint16_t reciprocals[64];
    static int16_t blocks[BLOCKS * 64], out[BLOCKS * MOST];
    int32_t lengths[BLOCKS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t p = 0; p < 64; p++)
        reciprocals[p] = (uint16_t)(65536 / (8 + 2 * (p / 8 + p % 8)));
    for (int32_t b = 0; b < BLOCKS; b++)
        for (int32_t p = 0; p < 64; p++)
            blocks[64 * b + p] = (int16_t)((lcg_below(&s, 801) - 400) >> ((p / 8 + p % 8) >> 1));

    CYC_READ(c0);
    for (int32_t b = 0; b < BLOCKS; b++)
        lengths[b] = quantise_zigzag(blocks + 64 * b, reciprocals, order, out + MOST * b);
    CYC_READ(c1);

    h = fnv_i16(h, out, BLOCKS * MOST);
    h = fnv_i32(h, lengths, BLOCKS);
    report("quantise_zigzag", c1 - c0, h);
    PARAMS(SEED, BLOCKS * 64, "coefficient");
    PARAM("blocks", BLOCKS);
    PARAMS_END();
    return 0;
}
