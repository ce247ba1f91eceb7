/* Paints the runs of background that touch marked pixels of the row above, with a list of ends. */
#include "ref.h"

#define SEED 1244u
#define W 48
#define H 24

KERNEL int32_t paint_runs(uint8_t image[], int32_t w, int32_t h, int16_t ends[])
{
    int32_t painted = 0;
    for (int32_t y = 1; y < h; y++) {
        int32_t row = y * w;
        int32_t x = 0;
        int32_t n = 0;
        while (x < w) {
            int32_t start = x;
            while (x < w && image[row + x] == 0) {
                x++;
            }
            int32_t touched = 0;
            for (int32_t i = start; i < x; i++) {
                if (image[row - w + i] == 2) {
                    touched = 1;
                }
            }
            if (touched != 0) {
                for (int32_t i = start; i < x; i++) {
                    image[row + i] = 2;
                }
                ends[n] = (int16_t)x;
                n++;
                painted += x - start;
            }
            x++;
        }
    }
    return painted;
}

int main(void)
{
    static uint8_t image[W * H];
    static int16_t ends[W];
    int32_t painted;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = lcg_u8(&s) < 80;
    for (int32_t i = 0; i < W; i++)
        image[i] = 2;

    CYC_READ(c0);
    painted = paint_runs(image, W, H, ends);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_val32(h, (uint32_t)painted);
    report("paint_runs", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
