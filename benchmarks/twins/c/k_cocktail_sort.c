/* Sorting by exchanges, forwards and backwards in turn. */
#include "ref.h"

#define SEED 1501u
#define N 60

KERNEL void cocktail_sort(uint8_t a[], int32_t n)
{
    int32_t left = 0;
    int32_t right = n - 1;
    while (left < right) {
        int32_t last = left;
        for (int32_t i = left; i < right; i++) {
            if (a[i] > a[i + 1]) {
                int32_t t = a[i];
                a[i] = a[i + 1];
                a[i + 1] = (uint8_t)t;
                last = i;
            }
        }
        right = last;
        for (int32_t i = right; i > left; i--) {
            if (a[i - 1] > a[i]) {
                int32_t t = a[i];
                a[i] = a[i - 1];
                a[i - 1] = (uint8_t)t;
                last = i;
            }
        }
        left = last;
    }
}

int main(void)
{
    static uint8_t a[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    cocktail_sort(a, N);
    CYC_READ(c1);

    h = fnv_u8(h, a, N);
    report("cocktail_sort", c1 - c0, h);
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
