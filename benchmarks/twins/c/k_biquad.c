/* Second-order IIR filter, direct form I, 2.14 coefficients, saturated to 16 bits. */
#include "ref.h"

#define SEED 1122u
#define N 400

KERNEL void biquad(const int16_t in[], int16_t out[], int32_t n, int32_t b0, int32_t b1, int32_t b2,
                   int32_t a1, int32_t a2)
{
    int32_t x1 = 0;
    int32_t x2 = 0;
    int32_t y1 = 0;
    int32_t y2 = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t x = in[i];
        int32_t y = (b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2 + 8192) >> 14;
        if (y > 32767) {
            y = 32767;
        } else if (y < -32768) {
            y = -32768;
        }
        x2 = x1;
        x1 = x;
        y2 = y1;
        y1 = y;
        out[i] = (int16_t)y;
    }
}

int main(void)
{
    static int16_t in[N], out[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        in[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    biquad(in, out, N, 6000, 4000, 3000, -20000, 8000);
    CYC_READ(c1);

    report("biquad", c1 - c0, fnv_i16(FNV_INIT, out, N));
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAM("b0", 6000);
    PARAM("b1", 4000);
    PARAM("b2", 3000);
    PARAM("a1", -20000);
    PARAM("a2", 8000);
    PARAMS_END();
    return 0;
}
