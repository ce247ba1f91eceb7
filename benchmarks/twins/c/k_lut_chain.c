/* Two look-up tables one behind the other: a tone curve, then a class of each tone. */
#include "ref.h"

#define SEED 1101u
#define N 2000

KERNEL void lut_chain(const uint8_t src[], const uint8_t tone[], const uint8_t cls[],
                      uint8_t dst[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        dst[i] = cls[tone[src[i]]];
    }
}

int main(void)
{
    static uint8_t src[N], tone[256], cls[256], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 256; i++)
        tone[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 256; i++)
        cls[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    lut_chain(src, tone, cls, dst, N);
    CYC_READ(c1);

    report("lut_chain", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
