/* Fill by spans from a seed, with a stack of (x, y). Returns the deepest stack. */
#include "ref.h"

#define SEED 1226u
#define W 40
#define H 30

KERNEL int32_t span_fill(uint8_t image[], int32_t w, int32_t h, int32_t x, int32_t y, int16_t stack[])
{
    int32_t sp = 2;
    int32_t deepest = 2;
    stack[0] = (int16_t)x;
    stack[1] = (int16_t)y;
    while (sp > 0) {
        sp -= 2;
        x = stack[sp];
        y = stack[sp + 1];
        int32_t row = y * w;
        while (x > 0 && image[row + x - 1] == 0) {
            x--;
        }
        int32_t above = 0;
        int32_t below = 0;
        while (x < w && image[row + x] == 0) {
            image[row + x] = 2;
            if (y > 0) {
                if (image[row - w + x] != 0) {
                    above = 0;
                } else if (above == 0) {
                    stack[sp] = (int16_t)x;
                    stack[sp + 1] = (int16_t)(y - 1);
                    sp += 2;
                    above = 1;
                }
            }
            if (y < h - 1) {
                if (image[row + w + x] != 0) {
                    below = 0;
                } else if (below == 0) {
                    stack[sp] = (int16_t)x;
                    stack[sp + 1] = (int16_t)(y + 1);
                    sp += 2;
                    below = 1;
                }
            }
            x++;
        }
        if (sp > deepest) {
            deepest = sp;
        }
    }
    return deepest;
}

int main(void)
{
    static uint8_t image[W * H];
    static int16_t stack[1000];
    int32_t deepest;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = lcg_u8(&s) < 60;
    image[15 * W + 20] = 0;

    CYC_READ(c0);
    deepest = span_fill(image, W, H, 20, 15, stack);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_val32(h, (uint32_t)deepest);
    report("span_fill", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
