/* Comb sort: exchanges at a gap that shrinks by 10/13. */
#include "ref.h"

#define SEED 1302u
#define N 150

KERNEL void comb_sort(int32_t a[], int32_t n)
{
    int32_t gap = n;
    int32_t swapped = 1;
    while (gap > 1 || swapped != 0) {
        gap = (gap * 79) >> 7;
        if (gap < 1) {
            gap = 1;
        }
        swapped = 0;
        for (int32_t i = 0; i < n - gap; i++) {
            int32_t x = a[i];
            int32_t y = a[i + gap];
            if (x > y) {
                a[i] = y;
                a[i + gap] = x;
                swapped = 1;
            }
        }
    }
}

int main(void)
{
    static int32_t a[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = lcg_u16(&s) - 32768;

    CYC_READ(c0);
    comb_sort(a, N);
    CYC_READ(c1);

    h = fnv_i32(h, a, N);
    report("comb_sort", c1 - c0, h);
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
