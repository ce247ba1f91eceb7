/* Integer square roots by Newton's method, from a power of two that is not too small. */
#include "ref.h"

#define SEED 1142u
#define N 24

KERNEL void newton_sqrt(const uint32_t values[], uint16_t roots[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t v = values[i];
        uint32_t x = 2;
        uint32_t t = v;
        while (t > 3) {
            t >>= 2;
            x <<= 1;
        }
        uint32_t y = (x + v / x) >> 1;
        while (y < x) {
            x = y;
            y = (x + v / x) >> 1;
        }
        roots[i] = (uint16_t)x;
    }
}

int main(void)
{
    static uint32_t values[N];
    static uint16_t roots[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* shifted right by the number of the value */
    for (int32_t i = 0; i < N; i++)
        values[i] = lcg_next(&s) >> i;

    CYC_READ(c0);
    newton_sqrt(values, roots, N);
    CYC_READ(c1);

    report("newton_sqrt", c1 - c0, fnv_u16(FNV_INIT, roots, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
