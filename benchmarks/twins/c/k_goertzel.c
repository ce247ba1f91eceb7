/* Power of samples at each of some frequencies (Goertzel), 14 bits behind the point. */
#include "ref.h"

#define SEED 1224u
#define N 64
#define M 8

KERNEL void goertzel(const int16_t samples[], int32_t n, const int16_t coefficient[], int32_t power[], int32_t m)
{
    for (int32_t k = 0; k < m; k++) {
        int32_t c = coefficient[k];
        int32_t s1 = 0;
        int32_t s2 = 0;
        for (int32_t i = 0; i < n; i++) {
            int32_t s0 = samples[i] + ((c * s1) >> 14) - s2;
            s2 = s1;
            s1 = s0;
        }
        int32_t cross = (c * s1) >> 14;
        power[k] = s1 * s1 + s2 * s2 - cross * s2;
    }
}

int main(void)
{
    static int16_t samples[N], coefficient[M];
    static int32_t power[M];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        samples[i] = (int16_t)(lcg_below(&s, 200) - 100);
    for (int32_t i = 0; i < M; i++)
        coefficient[i] = (int16_t)(lcg_below(&s, 60000) - 30000);

    CYC_READ(c0);
    goertzel(samples, N, coefficient, power, M);
    CYC_READ(c1);

    report("goertzel", c1 - c0, fnv_i32(FNV_INIT, power, M));
    PARAMS(SEED, N * M, "sample");
    PARAM("n", N);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
