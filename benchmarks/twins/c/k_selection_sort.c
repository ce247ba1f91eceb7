/* Selection sort of n 32-bit values, in place. */
#include "ref.h"

#define SEED 1201u
#define N 120

KERNEL void selection_sort(int32_t a[], int32_t n)
{
    for (int32_t i = 0; i < n - 1; i++) {
        int32_t least = i;
        for (int32_t j = i + 1; j < n; j++) {
            if (a[j] < a[least]) {
                least = j;
            }
        }
        int32_t t = a[i];
        a[i] = a[least];
        a[least] = t;
    }
}

int main(void)
{
    static int32_t a[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = lcg_u16(&s) - 32768;

    CYC_READ(c0);
    selection_sort(a, N);
    CYC_READ(c1);

    report("selection_sort", c1 - c0, fnv_i32(FNV_INIT, a, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
