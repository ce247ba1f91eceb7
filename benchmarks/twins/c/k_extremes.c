/* Smallest and largest of n 16-bit values and where they first are. */
#include "ref.h"

#define SEED 1133u
#define N 1000

KERNEL void extremes(const int16_t a[], int32_t n, int32_t out[])
{
    int32_t low = 32767;
    int32_t high = -32768;
    int32_t low_at = 0;
    int32_t high_at = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t v = a[i];
        if (v < low) {
            low = v;
            low_at = i;
        }
        if (v > high) {
            high = v;
            high_at = i;
        }
    }
    out[0] = low;
    out[1] = high;
    out[2] = low_at;
    out[3] = high_at;
}

int main(void)
{
    static int16_t a[N];
    static int32_t out[4];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    extremes(a, N, out);
    CYC_READ(c1);

    report("extremes", c1 - c0, fnv_i32(FNV_INIT, out, 4));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
