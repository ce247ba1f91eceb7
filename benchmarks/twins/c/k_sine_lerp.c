/* Sine of 16-bit angles from a quarter table of 65 values, interpolated. */
#include "ref.h"

#define SEED 1208u
#define N 500

KERNEL void sine_lerp(const uint16_t angle[], const int16_t quarter[], int16_t out[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t a = angle[i];
        int32_t phase = a & 0x3fff;
        if (a & 0x4000) {
            phase = 0x4000 - phase;
        }
        int32_t k = phase >> 8;
        int32_t y = quarter[k];
        if (k < 64) {
            y += ((quarter[k + 1] - y) * (phase & 255)) >> 8;
        }
        out[i] = (int16_t)(a & 0x8000 ? -y : y);
    }
}

int main(void)
{
    static uint16_t angle[N];
    static int16_t quarter[65], out[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        angle[i] = (uint16_t)lcg_u16(&s);
    for (int32_t i = 0; i < 65; i++)
        quarter[i] = (int16_t)(i * (760 - 4 * i));

    CYC_READ(c0);
    sine_lerp(angle, quarter, out, N);
    CYC_READ(c1);

    report("sine_lerp", c1 - c0, fnv_i16(FNV_INIT, out, N));
    PARAMS(SEED, N, "angle");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
