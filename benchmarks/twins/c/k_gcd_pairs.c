/* Greatest common divisors by remainders. */
#include "ref.h"

#define SEED 1140u
#define N 20

KERNEL void gcd_pairs(const uint16_t a[], const uint16_t b[], uint16_t gcd[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t x = a[i];
        uint32_t y = b[i];
        while (y != 0) {
            uint32_t t = x % y;
            x = y;
            y = t;
        }
        gcd[i] = (uint16_t)x;
    }
}

int main(void)
{
    static uint16_t a[N], b[N], gcd[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint16_t)lcg_u16(&s);
    for (int32_t i = 0; i < N; i++)
        b[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    gcd_pairs(a, b, gcd, N);
    CYC_READ(c1);

    report("gcd_pairs", c1 - c0, fnv_u16(FNV_INIT, gcd, N));
    PARAMS(SEED, N, "pair");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
