/* Draw as many particles anew, by their weights, at even steps; how many of the old ones are left. */
#include "ref.h"

#define SEED 2932u
#define N 200

KERNEL int32_t resample_particles(const int16_t *xs, const int16_t *ys, const uint16_t *weights, int32_t n, int32_t start,
                                  int16_t *new_xs, int16_t *new_ys, int32_t mean[2])
{
    int32_t total = 0;
    for (int32_t i = 0; i < n; i++)
        total += weights[i];
    int32_t step = total / n;
    int32_t at = start * step / 256;
    int32_t reached = weights[0], left = 1, i = 0, sum_x = 0, sum_y = 0;
    for (int32_t k = 0; k < n; k++) {
        if (reached <= at)
            left++;
        while (reached <= at)
            reached += weights[++i];
        new_xs[k] = xs[i];
        new_ys[k] = ys[i];
        sum_x += xs[i];
        sum_y += ys[i];
        at += step;
    }
    mean[0] = sum_x / n;
    mean[1] = sum_y / n;
    return left;
}

int main(void)
{
    static int16_t xs[N], ys[N], new_xs[N], new_ys[N];
    static uint16_t weights[N];
    int32_t mean[2];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        xs[i] = lcg_below(&s, 3000);
    for (int32_t i = 0; i < N; i++)
        ys[i] = lcg_below(&s, 2000);
    for (int32_t i = 0; i < N; i++) {
        int32_t weight = lcg_below(&s, 200);
        weights[i] = weight * lcg_below(&s, 200) >> 6;
    }

    CYC_READ(c0);
    int32_t left = resample_particles(xs, ys, weights, N, 77, new_xs, new_ys, mean);
    CYC_READ(c1);

    h = fnv_i16(h, new_xs, N);
    h = fnv_i16(h, new_ys, N);
    h = fnv_i32(h, mean, 2);
    h = fnv_i32(h, &left, 1);
    report("resample_particles", c1 - c0, h);
    PARAMS(SEED, N, "particle");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
