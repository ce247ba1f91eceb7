/* Histogram of disparities in each row, and the most frequent; 0 is no disparity. */
#include "ref.h"

#define SEED 2813u
#define W 80
#define H 24
#define LEVELS 32

KERNEL void v_disparity(const uint8_t *disparity, int32_t w, int32_t h, int32_t levels, uint16_t *counts, uint8_t *peaks)
{
    for (int32_t i = 0; i < h * levels; i++)
        counts[i] = 0;
    for (int32_t y = 0; y < h; y++) {
        uint16_t *row = counts + y * levels;
        for (int32_t x = 0; x < w; x++) {
            int32_t d = disparity[y * w + x];
            if (d > 0) {
                if (d > levels - 1)
                    d = levels - 1;
                row[d]++;
            }
        }
        int32_t most = 0, peak = 0;
        for (int32_t level = 1; level < levels; level++) {
            if (row[level] > most) {
                most = row[level];
                peak = level;
            }
        }
        peaks[y] = peak;
    }
}

int main(void)
{
    static uint8_t disparity[W * H], peaks[H];
    static uint16_t counts[H * LEVELS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        disparity[i] = (uint8_t)lcg_below(&s, 36);

    CYC_READ(c0);
    v_disparity(disparity, W, H, LEVELS, counts, peaks);
    CYC_READ(c1);

    h = fnv_u16(h, counts, H * LEVELS);
    h = fnv_u8(h, peaks, H);
    report("v_disparity", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
