/* From each of some points to the left and to the right as far as the picture is dark. */
#include "ref.h"

#define SEED 1247u
#define W 64
#define H 16
#define N 100

KERNEL void left_edges(const uint8_t image[], int32_t w, const uint8_t px[], const uint8_t py[], int32_t n,
                       int32_t level, uint8_t left[], uint8_t width[])
{
    for (int32_t i = 0; i < n; i++) {
        int32_t row = py[i] * w;
        int32_t a = px[i];
        int32_t b = a;
        while (a > 0 && image[row + a - 1] < level) {
            a--;
        }
        while (b < w - 1 && image[row + b + 1] < level) {
            b++;
        }
        left[i] = (uint8_t)a;
        width[i] = (uint8_t)(b - a + 1);
    }
}

int main(void)
{
    static uint8_t image[W * H], px[N], py[N], left[N], width[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        px[i] = (uint8_t)lcg_below(&s, W);
    for (int32_t i = 0; i < N; i++)
        py[i] = (uint8_t)lcg_below(&s, H);

    CYC_READ(c0);
    left_edges(image, W, px, py, N, 220, left, width);
    CYC_READ(c1);

    h = fnv_u8(h, left, N);
    h = fnv_u8(h, width, N);
    report("left_edges", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
