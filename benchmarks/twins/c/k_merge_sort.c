/* Merge sort of n 16-bit values from the bottom up, between two arrays. */
#include "ref.h"

#define SEED 1221u
#define N 128

KERNEL void merge_sort(int16_t a[], int16_t b[], int32_t n)
{
    for (int32_t width = 1; width < n; width = width * 2) {
        int32_t start = 0;
        while (start < n) {
            int32_t mid = start + width;
            int32_t end = mid + width;
            if (mid > n) {
                mid = n;
            }
            if (end > n) {
                end = n;
            }
            int32_t i = start;
            int32_t j = mid;
            for (int32_t k = start; k < end; k++) {
                if (i < mid && (j >= end || a[i] <= a[j])) {
                    b[k] = a[i];
                    i++;
                } else {
                    b[k] = a[j];
                    j++;
                }
            }
            start = end;
        }
        for (int32_t k = 0; k < n; k++) {
            a[k] = b[k];
        }
    }
}

int main(void)
{
    static int16_t a[N], b[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)(lcg_below(&s, 20000) - 10000);

    CYC_READ(c0);
    merge_sort(a, b, N);
    CYC_READ(c1);

    report("merge_sort", c1 - c0, fnv_i16(FNV_INIT, a, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
