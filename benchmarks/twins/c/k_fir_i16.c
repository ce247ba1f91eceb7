/* FIR filter of 16-bit samples with 1.15 coefficients; reads taps - 1 samples past n. */
#include "ref.h"

#define SEED 1123u
#define N 128
#define TAPS 16

KERNEL void fir_i16(const int16_t x[], const int16_t coef[], int16_t y[], int32_t n, int32_t taps)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t sum = 1 << 14;
        for (int32_t k = 0; k < taps; k++) {
            sum += x[i + k] * coef[k];
        }
        y[i] = (int16_t)(sum >> 15);
    }
}

int main(void)
{
    static int16_t x[N + TAPS], coef[TAPS], y[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N + TAPS; i++)
        x[i] = (int16_t)(lcg_u16(&s) - 32768);
    for (int32_t i = 0; i < TAPS; i++)
        coef[i] = (int16_t)(lcg_below(&s, 4000) - 2000);

    CYC_READ(c0);
    fir_i16(x, coef, y, N, TAPS);
    CYC_READ(c1);

    report("fir_i16", c1 - c0, fnv_i16(FNV_INIT, y, N));
    PARAMS(SEED, N*TAPS, "tap");
    PARAM("n", N);
    PARAM("taps", TAPS);
    PARAMS_END();
    return 0;
}
