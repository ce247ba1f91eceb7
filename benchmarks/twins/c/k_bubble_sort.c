/* Bubble sort that stops after a pass without a swap. Returns the passes. */
#include "ref.h"

#define SEED 1301u
#define N 80

KERNEL int32_t bubble_sort(int16_t a[], int32_t n)
{
    int32_t passes = 0;
    int32_t swapped = 1;
    while (swapped != 0) {
        swapped = 0;
        for (int32_t i = 1; i < n; i++) {
            if (a[i - 1] > a[i]) {
                int32_t t = a[i];
                a[i] = a[i - 1];
                a[i - 1] = (int16_t)t;
                swapped = 1;
            }
        }
        passes++;
        n--;
    }
    return passes;
}

int main(void)
{
    static int16_t a[N];
    int32_t passes;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    passes = bubble_sort(a, N);
    CYC_READ(c1);

    h = fnv_i16(h, a, N);
    h = fnv_val32(h, (uint32_t)passes);
    report("bubble_sort", c1 - c0, h);
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
