/* Median of three neighbours of a row. */
#include "ref.h"

#define SEED 1118u
#define N 500

KERNEL void median3_row(const uint8_t src[], uint8_t dst[], int32_t n)
{
    dst[0] = src[0];
    dst[n - 1] = src[n - 1];
    for (int32_t i = 1; i < n - 1; i++) {
        int32_t a = src[i - 1];
        int32_t b = src[i];
        int32_t c = src[i + 1];
        if (a > b) {
            int32_t t = a;
            a = b;
            b = t;
        }
        if (b > c) {
            b = c;
            if (a > b) {
                b = a;
            }
        }
        dst[i] = (uint8_t)b;
    }
}

int main(void)
{
    static uint8_t src[N], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    median3_row(src, dst, N);
    CYC_READ(c1);

    report("median3_row", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
