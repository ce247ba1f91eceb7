/* Quicksort of n 16-bit values with a stack of pending ranges instead of recursion;
 * the larger part is put off. */
#include "ref.h"

#define SEED 1117u
#define N 300
#define STACK 40

KERNEL void quick_sort(int16_t a[], int16_t stack[], int32_t n)
{
    int32_t sp = 2;
    stack[0] = 0;
    stack[1] = (int16_t)(n - 1);
    while (sp > 0) {
        sp = sp - 2;
        int32_t lo = stack[sp];
        int32_t hi = stack[sp + 1];
        while (lo < hi) {
            int32_t pivot = a[(lo + hi) >> 1];
            int32_t i = lo;
            int32_t j = hi;
            while (i <= j) {
                while (a[i] < pivot) {
                    i++;
                }
                while (a[j] > pivot) {
                    j--;
                }
                if (i <= j) {
                    int32_t t = a[i];
                    a[i] = a[j];
                    a[j] = (int16_t)t;
                    i++;
                    j--;
                }
            }
            if (j - lo < hi - i) {
                if (i < hi) {
                    stack[sp] = (int16_t)i;
                    stack[sp + 1] = (int16_t)hi;
                    sp = sp + 2;
                }
                hi = j;
            } else {
                if (lo < j) {
                    stack[sp] = (int16_t)lo;
                    stack[sp + 1] = (int16_t)j;
                    sp = sp + 2;
                }
                lo = i;
            }
        }
    }
}

int main(void)
{
    static int16_t a[N], stack[STACK];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (int16_t)(lcg_below(&s, 2000) - 1000);

    CYC_READ(c0);
    quick_sort(a, stack, N);
    CYC_READ(c1);

    report("quick_sort", c1 - c0, fnv_i16(FNV_INIT, a, N));
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAM("stack", STACK);
    PARAMS_END();
    return 0;
}
