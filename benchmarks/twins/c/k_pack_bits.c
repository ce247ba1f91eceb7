/* Threshold: eight pixels to a byte, the first one in the top bit. */
#include "ref.h"

#define SEED 1112u
#define N 200
#define THR 100

KERNEL void pack_bits(const uint8_t src[], uint8_t dst[], int32_t n, int32_t thr)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t b = 0;
        for (int32_t k = 0; k < 8; k++) {
            b = b << 1;
            if (src[i * 8 + k] > thr) {
                b = b | 1;
            }
        }
        dst[i] = (uint8_t)b;
    }
}

int main(void)
{
    static uint8_t src[N * 8], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N * 8; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    pack_bits(src, dst, N, THR);
    CYC_READ(c1);

    report("pack_bits", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N*8, "pixel");
    PARAM("n", N);
    PARAM("thr", THR);
    PARAMS_END();
    return 0;
}
