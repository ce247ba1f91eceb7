/* Clear the pixels without a neighbour at one of four sides; 32 pixels a word, the leftmost in bit 31. */
#include "ref.h"

#define SEED 2811u
#define WORDS 10
#define ROWS 24

KERNEL void despeckle_words(const uint32_t *bits, int32_t words, int32_t rows, uint32_t *out)
{
    for (int32_t y = 0; y < rows; y++) {
        for (int32_t i = 0; i < words; i++) {
            const uint32_t *p = bits + y * words + i;
            uint32_t near = (*p << 1) | (*p >> 1);
            if (i > 0)
                near |= p[-1] << 31;
            if (i < words - 1)
                near |= p[1] >> 31;
            if (y > 0)
                near |= p[-words];
            if (y < rows - 1)
                near |= p[words];
            *out++ = *p & near;
        }
    }
}

int main(void)
{
    static uint32_t bits[WORDS * ROWS], out[WORDS * ROWS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < WORDS * ROWS; i++) {
        bits[i] = lcg_next(&s);
        bits[i] &= lcg_next(&s);
    }

    CYC_READ(c0);
    despeckle_words(bits, WORDS, ROWS, out);
    CYC_READ(c1);

    report("despeckle_words", c1 - c0, fnv_u32(FNV_INIT, out, WORDS * ROWS));
    PARAMS(SEED, WORDS * ROWS, "word");
    PARAM("words", WORDS);
    PARAM("rows", ROWS);
    PARAMS_END();
    return 0;
}
