/* Median of the last five samples, by insertion into a sorted window. */
#include "ref.h"

#define SEED 1408u
#define N 150
#define K 5

KERNEL void median_window(const int16_t x[], int32_t n, int32_t k, int16_t window[], int16_t out[])
{
    for (int32_t i = 0; i <= n - k; i++) {
        for (int32_t j = 0; j < k; j++) {
            int32_t v = x[i + j];
            int32_t m = j - 1;
            while (m >= 0 && window[m] > v) {
                window[m + 1] = window[m];
                m--;
            }
            window[m + 1] = (int16_t)v;
        }
        out[i] = window[k >> 1];
    }
}

int main(void)
{
    static int16_t x[N], window[K], out[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    median_window(x, N, K, window, out);
    CYC_READ(c1);

    h = fnv_i16(h, out, N);
    report("median_window", c1 - c0, h);
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAM("k", K);
    PARAMS_END();
    return 0;
}
