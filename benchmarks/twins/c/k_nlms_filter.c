/* Take out of what is heard what the reference explains (normalised LMS); weights with 14 fractional bits. */
#include "ref.h"

#define SEED 3021u
#define N 240
#define TAPS 12

static int32_t limit(int32_t value, int32_t low, int32_t high)
{
    if (value < low)
        return low;
    return value > high ? high : value;
}

KERNEL void nlms_filter(const int16_t *reference, const int16_t *heard, int32_t n, int32_t taps, int16_t *weights,
                        int16_t *errors)
{
    int32_t power = 0;

    for (int32_t i = 0; i < taps; i++)
        power += reference[i] * reference[i] >> 6;
    for (int32_t i = taps; i < n; i++) {
        const int16_t *now = reference + i;
        int32_t newest = now[0], oldest = now[-taps], estimate = 0;
        power += (newest * newest >> 6) - (oldest * oldest >> 6);
        for (int32_t k = 0; k < taps; k++)
            estimate += weights[k] * now[-k];
        int32_t error = limit(heard[i] - (estimate >> 14), INT16_MIN, INT16_MAX);
        int32_t step = limit(error * 4096 / (power + 64), -8191, 8191);
        for (int32_t k = 0; k < taps; k++)
            weights[k] = limit(weights[k] + (step * now[-k] >> 5), INT16_MIN, INT16_MAX);
        errors[i] = error;
    }
}

int main(void)
{
    static int16_t reference[N], heard[N], weights[TAPS], errors[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        reference[i] = lcg_below(&s, 4001) - 2000;
    for (int32_t i = 4; i < N; i++) {
        int32_t echo = 3 * reference[i - 2] - 2 * reference[i - 4] + reference[i];
        heard[i] = (echo >> 3) + lcg_below(&s, 101) - 50;
    }

    CYC_READ(c0);
    nlms_filter(reference, heard, N, TAPS, weights, errors);
    CYC_READ(c1);

    h = fnv_i16(h, weights, TAPS);
    h = fnv_i16(h, errors, N);
    report("nlms_filter", c1 - c0, h);
    PARAMS(SEED, N - TAPS, "sample");
    PARAM("n", N);
    PARAM("taps", TAPS);
    PARAMS_END();
    return 0;
}
