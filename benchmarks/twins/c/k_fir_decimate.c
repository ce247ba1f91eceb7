/* FIR filter that keeps every second sample, rounded and saturated to 16 bits. */
#include "ref.h"

#define SEED 1308u
#define N 256
#define TAPS 12

KERNEL void fir_decimate(const int16_t x[], int32_t n, const int16_t taps[], int32_t k, int16_t y[])
{
    int32_t o = 0;
    for (int32_t i = k - 1; i < n; i += 2) {
        int32_t sum = 1 << 13;
        for (int32_t t = 0; t < k; t++) {
            sum += x[i - t] * taps[t];
        }
        sum = sum >> 14;
        if (sum > 32767) {
            sum = 32767;
        }
        if (sum < -32768) {
            sum = -32768;
        }
        y[o] = (int16_t)sum;
        o++;
    }
}

int main(void)
{
    static int16_t x[N], taps[TAPS], y[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (int16_t)(lcg_u16(&s) - 32768);
    for (int32_t i = 0; i < TAPS; i++)
        taps[i] = (int16_t)(lcg_below(&s, 8192) - 4096);

    CYC_READ(c0);
    fir_decimate(x, N, taps, TAPS, y);
    CYC_READ(c1);

    h = fnv_i16(h, y, N);
    report("fir_decimate", c1 - c0, h);
    PARAMS(SEED, N / 2, "sample");
    PARAM("n", N);
    PARAM("taps", TAPS);
    PARAMS_END();
    return 0;
}
