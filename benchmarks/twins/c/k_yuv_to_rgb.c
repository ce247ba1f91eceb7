/* BT.601 in 8.8, each result clamped to 0..255 by a function. */
#include "ref.h"

#define SEED 1132u
#define N 200

HELPER int32_t clamp8(int32_t v)
{
    if (v < 0) {
        return 0;
    }
    if (v > 255) {
        return 255;
    }
    return v;
}

KERNEL void yuv_to_rgb(const uint8_t y[], const uint8_t u[], const uint8_t v[], uint8_t rgb[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t c = 298 * (y[i] - 16) + 128;
        int32_t d = u[i] - 128;
        int32_t e = v[i] - 128;
        rgb[3 * i] = (uint8_t)clamp8((c + 409 * e) >> 8);
        rgb[3 * i + 1] = (uint8_t)clamp8((c - 100 * d - 208 * e) >> 8);
        rgb[3 * i + 2] = (uint8_t)clamp8((c + 516 * d) >> 8);
    }
}

int main(void)
{
    static uint8_t y[N], u[N], v[N], rgb[3 * N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        y[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        u[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        v[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    yuv_to_rgb(y, u, v, rgb, N);
    CYC_READ(c1);

    report("yuv_to_rgb", c1 - c0, fnv_u8(FNV_INIT, rgb, 3 * N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
