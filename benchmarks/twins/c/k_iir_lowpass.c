/* One-pole low pass of 16-bit samples, with saturation to a limit. */
#include "ref.h"

#define SEED 1204u
#define N 500
#define GAIN 5243
#define LIMIT 9000

KERNEL int32_t iir_lowpass(const int16_t in[], int16_t out[], int32_t n, int32_t gain, int32_t limit)
{
    int32_t state = 0;
    int32_t clipped = 0;
    for (int32_t i = 0; i < n; i++) {
        state += ((in[i] * 16 - state) * (gain >> 8)) >> 8;
        int32_t y = state >> 4;
        if (y > limit) {
            y = limit;
            clipped++;
        } else if (y < -limit) {
            y = -limit;
            clipped++;
        }
        out[i] = (int16_t)y;
    }
    return clipped;
}

int main(void)
{
    static int16_t in[N], out[N];
    int32_t clipped;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        in[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    clipped = iir_lowpass(in, out, N, GAIN, LIMIT);
    CYC_READ(c1);

    h = fnv_i16(h, out, N);
    h = fnv_val32(h, (uint32_t)clipped);
    report("iir_lowpass", c1 - c0, h);
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAM("gain", GAIN);
    PARAM("limit", LIMIT);
    PARAMS_END();
    return 0;
}
