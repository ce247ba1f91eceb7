/* Straight lines between pairs of points, drawn pixel by pixel. */
#include "ref.h"

#define SEED 1141u
#define N 20
#define W 64
#define H 48

KERNEL void bresenham(uint8_t image[], int32_t w, const int16_t x0[], const int16_t y0[],
                      const int16_t x1[], const int16_t y1[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t x = x0[i];
        int32_t y = y0[i];
        int32_t ex = x1[i];
        int32_t ey = y1[i];
        int32_t dx = ex - x;
        int32_t dy = y - ey;
        int32_t sx = 1;
        int32_t sy = 1;
        if (dx < 0) {
            dx = -dx;
            sx = -1;
        }
        if (dy > 0) {
            dy = -dy;
            sy = -1;
        }
        int32_t err = dx + dy;
        for (;;) {
            image[y * w + x] = (uint8_t)(i + 1);
            if (x == ex && y == ey) {
                break;
            }
            int32_t twice = 2 * err;
            if (twice >= dy) {
                err += dy;
                x += sx;
            }
            if (twice <= dx) {
                err += dx;
                y += sy;
            }
        }
    }
}

int main(void)
{
    static uint8_t image[W * H];
    static int16_t x0[N], y0[N], x1[N], y1[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* four draws per line: x0, y0, x1, y1 */
    for (int32_t i = 0; i < N; i++) {
        x0[i] = (int16_t)lcg_below(&s, W);
        y0[i] = (int16_t)lcg_below(&s, H);
        x1[i] = (int16_t)lcg_below(&s, W);
        y1[i] = (int16_t)lcg_below(&s, H);
    }

    CYC_READ(c0);
    bresenham(image, W, x0, y0, x1, y1, N);
    CYC_READ(c1);

    report("bresenham", c1 - c0, fnv_u8(FNV_INIT, image, W * H));
    PARAMS(SEED, N, "line");
    PARAM("n", N);
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
