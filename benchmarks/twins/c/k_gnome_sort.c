/* Gnome sort: one step back after each exchange. */
#include "ref.h"

#define SEED 2101u
#define N 60

KERNEL void gnome_sort(int16_t a[], int32_t n)
{
    int32_t i = 1;
    while (i < n) {
        if (i == 0 || a[i] >= a[i - 1]) {
            i = i + 1;
        } else {
            int32_t t = a[i];
            a[i] = a[i - 1];
            a[i - 1] = (int16_t)t;
            i = i - 1;
        }
    }
}

int main(void)
{
    static int16_t a[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)lcg_u16(&s);

    CYC_READ(c0);
    gnome_sort(a, N);
    CYC_READ(c1);

    report("gnome_sort", c1 - c0, fnv_u16(FNV_INIT, (uint16_t *)a, N));
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
