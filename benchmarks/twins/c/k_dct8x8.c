/* Discrete cosine transform of 8 x 8 blocks, rows then columns, by a table of 8 x 8 cosines in 1/4096ths. */
#include "ref.h"

#define SEED 1306u
#define BLOCKS 2

KERNEL void dct8x8(const uint8_t pixels[], const int16_t cosines[], int16_t rows[], int16_t out[], int32_t blocks)
{
    for (int32_t b = 0; b < blocks; b++) {
        for (int32_t y = 0; y < 8; y++) {
            for (int32_t u = 0; u < 8; u++) {
                int32_t sum = 0;
                for (int32_t x = 0; x < 8; x++) {
                    sum += (pixels[b * 64 + y * 8 + x] - 128) * cosines[u * 8 + x];
                }
                rows[y * 8 + u] = (int16_t)((sum + 2048) >> 12);
            }
        }
        for (int32_t u = 0; u < 8; u++) {
            for (int32_t v = 0; v < 8; v++) {
                int32_t sum = 0;
                for (int32_t y = 0; y < 8; y++) {
                    sum += rows[y * 8 + u] * cosines[v * 8 + y];
                }
                out[b * 64 + v * 8 + u] = (int16_t)((sum + 2048) >> 12);
            }
        }
    }
}

int main(void)
{
    static uint8_t pixels[64 * BLOCKS];
    static int16_t cosines[64], rows[64], out[64 * BLOCKS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 64 * BLOCKS; i++)
        pixels[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 64; i++)
        cosines[i] = (int16_t)(lcg_below(&s, 4096) - 2048);

    CYC_READ(c0);
    dct8x8(pixels, cosines, rows, out, BLOCKS);
    CYC_READ(c1);

    h = fnv_i16(h, out, 64 * BLOCKS);
    report("dct8x8", c1 - c0, h);
    PARAMS(SEED, 64 * BLOCKS, "pixel");
    PARAM("blocks", BLOCKS);
    PARAMS_END();
    return 0;
}
