/* A calibration curve: the segment by bisection, then a straight line with a slope in 1/256. */
#include "ref.h"

#define SEED 2102u
#define N 300
#define POINTS 40

KERNEL void curve_lookup(const uint16_t x[], const uint16_t y[], const int16_t slope[], int32_t points,
                         const uint16_t in[], int32_t out[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t v = in[i];
        int32_t lo = 0;
        int32_t hi = points - 1;
        while (hi - lo > 1) {
            int32_t mid = (lo + hi) >> 1;
            if (x[mid] > v)
                hi = mid;
            else
                lo = mid;
        }
        out[i] = y[lo] + (((v - x[lo]) * slope[lo]) >> 8);
    }
}

int main(void)
{
    static uint16_t x[POINTS], y[POINTS], in[N];
    static int16_t slope[POINTS];
    static int32_t out[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < POINTS; i++)
        x[i] = (uint16_t)(1000 * i + lcg_below(&s, 1000));
    for (int32_t i = 0; i < POINTS; i++)
        y[i] = (uint16_t)lcg_u16(&s);
    for (int32_t i = 0; i < POINTS; i++)
        slope[i] = (int16_t)lcg_u16(&s);
    for (int32_t i = 0; i < N; i++)
        in[i] = (uint16_t)lcg_below(&s, 40000);

    CYC_READ(c0);
    curve_lookup(x, y, slope, POINTS, in, out, N);
    CYC_READ(c1);

    report("curve_lookup", c1 - c0, fnv_i32(FNV_INIT, out, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAM("points", POINTS);
    PARAMS_END();
    return 0;
}
