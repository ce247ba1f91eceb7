/* Means of three values by a signed division, and a checksum modulo 97. */
#include "ref.h"

#define SEED 1146u
#define N 120

KERNEL int32_t thirds(const int16_t a[], int32_t n, int16_t out[])
{
    int32_t check = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t sum = a[3 * i] + a[3 * i + 1] + a[3 * i + 2];
        out[i] = (int16_t)(sum / 3);
        check = (check * 10 + sum) % 97;
    }
    return check;
}

int main(void)
{
    static int16_t a[3 * N], out[N];
    int32_t check;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* no negative ones */
    for (int32_t i = 0; i < 3 * N; i++)
        a[i] = (int16_t)lcg_below(&s, 32768);

    CYC_READ(c0);
    check = thirds(a, N, out);
    CYC_READ(c1);

    h = fnv_i16(h, out, N);
    h = fnv_val32(h, (uint32_t)check);
    report("thirds", c1 - c0, h);
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
