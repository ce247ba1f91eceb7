/* Fill from a seed with two stacks of coordinates; each pixel is marked when it is pushed. Returns the pixels. */
#include "ref.h"

#define SEED 1312u
#define W 32
#define H 24

KERNEL int32_t fill_xy(uint8_t image[], int32_t w, int32_t h, int32_t x0, int32_t y0, uint8_t xs[], uint8_t ys[],
                       const int16_t dx[], const int16_t dy[])
{
    int32_t filled = 1;
    int32_t top = 1;
    xs[0] = (uint8_t)x0;
    ys[0] = (uint8_t)y0;
    image[y0 * w + x0] = 2;
    while (top > 0) {
        top--;
        int32_t x = xs[top];
        int32_t y = ys[top];
        for (int32_t k = 0; k < 4; k++) {
            int32_t nx = x + dx[k];
            int32_t ny = y + dy[k];
            if (nx < 0 || ny < 0 || nx >= w || ny >= h) {
                continue;
            }
            if (image[ny * w + nx] == 0) {
                image[ny * w + nx] = 2;
                xs[top] = (uint8_t)nx;
                ys[top] = (uint8_t)ny;
                top++;
                filled++;
            }
        }
    }
    return filled;
}

int main(void)
{
    static uint8_t image[W * H], xs[W * H], ys[W * H];
    static const int16_t dx[4] = {1, 0, -1, 0}, dy[4] = {0, 1, 0, -1};
    int32_t filled;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = lcg_u8(&s) < 70;

    CYC_READ(c0);
    filled = fill_xy(image, W, H, W / 2, H / 2, xs, ys, dx, dy);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_val32(h, (uint32_t)filled);
    report("fill_xy", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
