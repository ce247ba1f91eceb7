/* Counting sort of n bytes, stable. */
#include "ref.h"

#define SEED 1116u
#define N 1000

KERNEL void counting_sort(const uint8_t src[], uint8_t dst[], uint16_t count[], int32_t n)
{
    for (int32_t i = 0; i < 256; i++) {
        count[i] = 0;
    }
    for (int32_t i = 0; i < n; i++) {
        count[src[i]]++;
    }
    for (int32_t i = 1; i < 256; i++) {
        count[i] = (uint16_t)(count[i] + count[i - 1]);
    }
    for (int32_t i = n - 1; i >= 0; i--) {
        int32_t v = src[i];
        int32_t k = count[v] - 1;
        count[v] = (uint16_t)k;
        dst[k] = (uint8_t)v;
    }
}

int main(void)
{
    static uint8_t src[N], dst[N];
    static uint16_t count[256];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    counting_sort(src, dst, count, N);
    CYC_READ(c1);

    h = fnv_u8(h, dst, N);
    h = fnv_u16(h, count, 256);
    report("counting_sort", c1 - c0, h);
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
