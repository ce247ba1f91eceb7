/* The line through two points that most others are near. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2804u
#define N 60
#define TRIES 20

KERNEL int32_t ransac_line(const int16_t xs[], const int16_t ys[], int32_t n, int32_t tries, int32_t line[3])
{
    uint32_t state = 12345;
    int32_t most = 0;
    for (int32_t t = 0; t < tries; t++) {
        state = state * 1103515245u + 12345u;
        int32_t i = ((state >> 16) * n) >> 16;
        state = state * 1103515245u + 12345u;
        int32_t j = ((state >> 16) * n) >> 16;
        if (i == j)
            continue;
        int32_t a = ys[i] - ys[j];
        int32_t b = xs[j] - xs[i];
        int32_t c = a * xs[i] + b * ys[i];
        int32_t limit = 2 * (abs(a) > abs(b) ? abs(a) : abs(b));
        int32_t inliers = 0;
        for (int32_t k = 0; k < n; k++) {
            if (abs(a * xs[k] + b * ys[k] - c) <= limit)
                inliers++;
        }
        if (inliers > most) {
            most = inliers;
            line[0] = a;
            line[1] = b;
            line[2] = c;
        }
    }
    return most;
}

int main(void)
{
    static int16_t xs[N], ys[N];
    static int32_t line[3];
    int32_t most;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        xs[i] = (int16_t)(4 * i);
        if (lcg_below(&s, 3))
            ys[i] = (int16_t)(30 + 2 * i + lcg_below(&s, 3));
        else
            ys[i] = (int16_t)lcg_below(&s, 240);
    }

    CYC_READ(c0);
    most = ransac_line(xs, ys, N, TRIES, line);
    CYC_READ(c1);

    h = fnv_i32(h, line, 3);
    h = fnv_val32(h, (uint32_t)most);
    report("ransac_line", c1 - c0, h);
    PARAMS(SEED, TRIES * N, "point");
    PARAM("tries", TRIES);
    PARAMS_END();
    return 0;
}
