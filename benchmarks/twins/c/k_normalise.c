/* Non-zero words as a 16-bit mantissa with its top bit set and a shift count. */
#include "ref.h"

#define SEED 1110u
#define N 200

KERNEL void normalise(const uint32_t values[], uint16_t mantissa[], uint8_t shift[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t v = values[i];
        int32_t e = 0;
        while ((v & 0x80000000u) == 0) {
            v = v << 1;
            e = e + 1;
        }
        mantissa[i] = (uint16_t)(v >> 16);
        shift[i] = (uint8_t)e;
    }
}

int main(void)
{
    static uint32_t values[N];
    static uint16_t mantissa[N];
    static uint8_t shift[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* shifted right by the number of the value, modulo 32, and odd */
    for (int32_t i = 0; i < N; i++)
        values[i] = (lcg_next(&s) >> (i & 31)) | 1u;

    CYC_READ(c0);
    normalise(values, mantissa, shift, N);
    CYC_READ(c1);

    h = fnv_u16(h, mantissa, N);
    h = fnv_u8(h, shift, N);
    report("normalise", c1 - c0, h);
    PARAMS(SEED, N, "value");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
