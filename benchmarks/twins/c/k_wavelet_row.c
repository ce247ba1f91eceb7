/* The 5/3 wavelet by lifting, in place; then low ones first. */
#include "ref.h"

#define SEED 2822u
#define N 320

KERNEL void wavelet_row(int16_t x[], int32_t n, int16_t out[])
{
    int32_t half = n / 2;
    for (int32_t i = 1; i < n - 1; i += 2)
        x[i] -= (x[i - 1] + x[i + 1]) >> 1;
    x[n - 1] -= x[n - 2];
    x[0] += (x[1] + 1) >> 1;
    for (int32_t i = 2; i < n; i += 2)
        x[i] += (x[i - 1] + x[i + 1] + 2) >> 2;
    for (int32_t i = 0; i < half; i++) {
        out[i] = x[2 * i];
        out[half + i] = x[2 * i + 1];
    }
}

int main(void)
{
    static int16_t x[N], out[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (int16_t)lcg_below(&s, 256);

    CYC_READ(c0);
    wavelet_row(x, N, out);
    CYC_READ(c1);

    report("wavelet_row", c1 - c0, fnv_i16(FNV_INIT, out, N));
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
