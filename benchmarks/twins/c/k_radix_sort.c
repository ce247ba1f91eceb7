/* Half-words sorted by their low, then by their high byte. */
#include "ref.h"

#define SEED 1401u
#define N 200

KERNEL void radix_sort(uint16_t a[], uint16_t b[], int32_t count[], int32_t n)
{
    for (int32_t shift = 0; shift < 16; shift += 8) {
        for (int32_t i = 0; i < 256; i++) {
            count[i] = 0;
        }
        for (int32_t i = 0; i < n; i++) {
            count[(a[i] >> shift) & 255]++;
        }
        int32_t sum = 0;
        for (int32_t i = 0; i < 256; i++) {
            int32_t c = count[i];
            count[i] = sum;
            sum += c;
        }
        for (int32_t i = 0; i < n; i++) {
            int32_t d = (a[i] >> shift) & 255;
            b[count[d]] = a[i];
            count[d]++;
        }
        for (int32_t i = 0; i < n; i++) {
            a[i] = b[i];
        }
    }
}

int main(void)
{
    static uint16_t a[N], b[N];
    static int32_t count[256];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    radix_sort(a, b, count, N);
    CYC_READ(c1);

    h = fnv_u16(h, a, N);
    report("radix_sort", c1 - c0, h);
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
