/* Points in 16 bits through a matrix of 2 x 3, 8 bits behind the point, cut to a window. */
#include "ref.h"

#define SEED 1223u
#define N 200
#define W 320
#define H 240

KERNEL int32_t affine_points(const int16_t x[], const int16_t y[], const int16_t m[], int32_t n, int16_t u[],
                             int16_t v[], int32_t w, int32_t h)
{
    int32_t kept = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t px = (m[0] * x[i] + m[1] * y[i] + m[2] * 256) >> 8;
        int32_t py = (m[3] * x[i] + m[4] * y[i] + m[5] * 256) >> 8;
        if (px >= 0 && px < w && py >= 0 && py < h) {
            u[kept] = (int16_t)px;
            v[kept] = (int16_t)py;
            kept++;
        }
    }
    return kept;
}

int main(void)
{
    static int16_t x[N], y[N], u[N], v[N];
    static const int16_t m[6] = {230, -110, 40, 110, 230, -60};
    int32_t kept;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (int16_t)lcg_below(&s, W);
    for (int32_t i = 0; i < N; i++)
        y[i] = (int16_t)lcg_below(&s, H);

    CYC_READ(c0);
    kept = affine_points(x, y, m, N, u, v, W, H);
    CYC_READ(c1);

    h = fnv_i16(h, u, N);
    h = fnv_i16(h, v, N);
    h = fnv_val32(h, (uint32_t)kept);
    report("affine_points", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
