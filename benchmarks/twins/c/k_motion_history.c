/* Mark what moved and let older marks fade; where the middle of what moved is, in 16ths of a pixel. */
#include "ref.h"
#include <stdlib.h>
#include <string.h>

#define SEED 2903u
#define W 80
#define H 30
#define FRAMES 3

struct point {
    int32_t x, y;
};

KERNEL int32_t motion_history(const uint8_t *now, uint8_t *before, uint8_t *history, int32_t w, int32_t h, int32_t threshold,
                              int32_t decay, struct point *centre)
{
    int32_t moved = 0, sum_x = 0, sum_y = 0;
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            if (abs(*now - *before) > threshold) {
                *history = 255;
                moved++;
                sum_x += x;
                sum_y += y;
            } else if (*history > decay) {
                *history -= decay;
            } else {
                *history = 0;
            }
            *before++ = *now++;
            history++;
        }
    }
    if (moved > 0) {
        centre->x = 16 * sum_x / moved;
        centre->y = 16 * sum_y / moved;
    }
    return moved;
}

int main(void)
{
    static uint8_t before[W * H], frames[FRAMES][W * H], history[W * H];
    static struct point centre;
    int32_t moved[FRAMES];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        before[i] = (uint8_t)lcg_u8(&s);
    for (int32_t f = 0; f < FRAMES; f++) {
        memcpy(frames[f], f ? frames[f - 1] : before, W * H);
        for (int32_t y = 8 + f; y < 18 + f; y++)
            for (int32_t x = 20 + 5 * f; x < 44 + 5 * f; x++)
                frames[f][W * y + x] = (uint8_t)lcg_u8(&s);
    }

    CYC_READ(c0);
    for (int32_t f = 0; f < FRAMES; f++)
        moved[f] = motion_history(frames[f], before, history, W, H, 24, 40, &centre);
    CYC_READ(c1);

    h = fnv_u8(h, history, W * H);
    h = fnv_u8(h, before, W * H);
    h = fnv_i32(h, &centre.x, 2);
    h = fnv_i32(h, moved, FRAMES);
    report("motion_history", c1 - c0, h);
    PARAMS(SEED, FRAMES * W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
