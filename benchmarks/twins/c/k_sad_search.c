/* Block matching along a row: for every block of 8 pixels the shift with the
 * smallest sum of absolute differences, and that sum. */
#include "ref.h"

#define SEED 1131u
#define W 128
#define BLOCKS 14
#define RANGE 16

KERNEL void sad_search(const uint8_t left[], const uint8_t right[], int32_t blocks, int32_t range,
                       uint8_t shift[], uint16_t score[])
{
    for (int32_t b = 0; b < blocks; b++) {
        int32_t x = range + b * 8;
        int32_t best = 65535;
        int32_t best_d = 0;
        for (int32_t d = 0; d < range; d++) {
            int32_t sad = 0;
            for (int32_t k = 0; k < 8; k++) {
                int32_t diff = left[x + k] - right[x - d + k];
                if (diff < 0) {
                    diff = -diff;
                }
                sad += diff;
            }
            if (sad < best) {
                best = sad;
                best_d = d;
            }
        }
        shift[b] = (uint8_t)best_d;
        score[b] = (uint16_t)best;
    }
}

int main(void)
{
    static uint8_t left[W], right[W], shift[BLOCKS];
    static uint16_t score[BLOCKS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W; i++)
        left[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < W; i++)
        right[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    sad_search(left, right, BLOCKS, RANGE, shift, score);
    CYC_READ(c1);

    h = fnv_u8(h, shift, BLOCKS);
    h = fnv_u16(h, score, BLOCKS);
    report("sad_search", c1 - c0, h);
    PARAMS(SEED, BLOCKS*RANGE, "block");
    PARAM("w", W);
    PARAM("blocks", BLOCKS);
    PARAM("range", RANGE);
    PARAMS_END();
    return 0;
}
