/* Heap sort of n 16-bit values, in place, ascending. */
#include "ref.h"

#define SEED 1114u
#define N 200

/* let the value at root sink until no child below end is larger */
HELPER void sift_down(int16_t a[], int32_t root, int32_t end)
{
    int32_t v = a[root];
    int32_t child = 2 * root + 1;
    while (child < end) {
        if (child + 1 < end && a[child + 1] > a[child]) {
            child++;
        }
        if (a[child] <= v) {
            break;
        }
        a[root] = a[child];
        root = child;
        child = 2 * root + 1;
    }
    a[root] = (int16_t)v;
}

KERNEL void heap_sort(int16_t a[], int32_t n)
{
    for (int32_t i = n / 2 - 1; i >= 0; i--) {
        sift_down(a, i, n);
    }
    for (int32_t end = n - 1; end > 0; end--) {
        int32_t t = a[0];
        a[0] = a[end];
        a[end] = (int16_t)t;
        sift_down(a, 0, end);
    }
}

int main(void)
{
    static int16_t a[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)(lcg_u16(&s) - 32768);

    CYC_READ(c0);
    heap_sort(a, N);
    CYC_READ(c1);

    report("heap_sort", c1 - c0, fnv_i16(FNV_INIT, a, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
