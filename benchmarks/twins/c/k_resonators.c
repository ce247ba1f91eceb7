/* Sum of the outputs of some resonators with two states each, 12 bits behind the point. */
#include "ref.h"

#define SEED 1241u
#define N 60
#define M 6

KERNEL void resonators(const int16_t in[], int32_t n, const int16_t a1[], const int16_t a2[], int32_t out[],
                       int32_t m)
{
    for (int32_t k = 0; k < m; k++) {
        int32_t y1 = 0;
        int32_t y2 = 0;
        int32_t sum = 0;
        for (int32_t i = 0; i < n; i++) {
            int32_t y = in[i] + ((a1[k] * y1 - a2[k] * y2) >> 12);
            sum += y < 0 ? -y : y;
            y2 = y1;
            y1 = y;
        }
        out[k] = sum;
    }
}

int main(void)
{
    static int16_t in[N], a1[M], a2[M];
    static int32_t out[M];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        in[i] = (int16_t)(lcg_below(&s, 2000) - 1000);
    for (int32_t i = 0; i < M; i++)
        a1[i] = (int16_t)(lcg_below(&s, 6000) - 3000);
    for (int32_t i = 0; i < M; i++)
        a2[i] = (int16_t)lcg_below(&s, 3000);

    CYC_READ(c0);
    resonators(in, N, a1, a2, out, M);
    CYC_READ(c1);

    report("resonators", c1 - c0, fnv_i32(FNV_INIT, out, M));
    PARAMS(SEED, N * M, "sample");
    PARAM("n", N);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
