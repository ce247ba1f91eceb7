/* Shell sort of n 32-bit values, in place, gaps n/2, n/4, .. 1. */
#include "ref.h"

#define SEED 1115u
#define N 200

KERNEL void shell_sort(int32_t a[], int32_t n)
{
    int32_t gap = n >> 1;
    while (gap > 0) {
        for (int32_t i = gap; i < n; i++) {
            int32_t v = a[i];
            int32_t j = i;
            while (j >= gap && a[j - gap] > v) {
                a[j] = a[j - gap];
                j = j - gap;
            }
            a[j] = v;
        }
        gap = gap >> 1;
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
    shell_sort(a, N);
    CYC_READ(c1);

    report("shell_sort", c1 - c0, fnv_i32(FNV_INIT, a, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
