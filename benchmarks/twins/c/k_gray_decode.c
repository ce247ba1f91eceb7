/* Gray codes of 16 bits to binary, and the parity of each. */
#include "ref.h"

#define SEED 1202u
#define N 500

KERNEL void gray_decode(const uint16_t gray[], uint16_t binary[], uint8_t parity[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t b = gray[i];
        uint32_t shift = 8;
        while (shift > 0) {
            b = b ^ (b >> shift);
            shift = shift >> 1;
        }
        binary[i] = (uint16_t)b;
        parity[i] = (uint8_t)(b & 1);
    }
}

int main(void)
{
    static uint16_t gray[N], binary[N];
    static uint8_t parity[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        gray[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    gray_decode(gray, binary, parity, N);
    CYC_READ(c1);

    h = fnv_u16(h, binary, N);
    h = fnv_u8(h, parity, N);
    report("gray_decode", c1 - c0, h);
    PARAMS(SEED, N, "code");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
