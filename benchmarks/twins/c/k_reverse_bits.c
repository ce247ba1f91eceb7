/* Bit order of every word reversed, in five exchanges. */
#include "ref.h"

#define SEED 1106u
#define N 500

KERNEL void reverse_bits(const uint32_t src[], uint32_t dst[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t w = src[i];
        w = ((w >> 1) & 0x55555555u) | ((w & 0x55555555u) << 1);
        w = ((w >> 2) & 0x33333333u) | ((w & 0x33333333u) << 2);
        w = ((w >> 4) & 0x0F0F0F0Fu) | ((w & 0x0F0F0F0Fu) << 4);
        w = ((w >> 8) & 0x00FF00FFu) | ((w & 0x00FF00FFu) << 8);
        w = (w >> 16) | (w << 16);
        dst[i] = w;
    }
}

int main(void)
{
    static uint32_t src[N], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = lcg_next(&s);

    CYC_READ(c0);
    reverse_bits(src, dst, N);
    CYC_READ(c1);

    report("reverse_bits", c1 - c0, fnv_u32(FNV_INIT, dst, N));
    PARAMS(SEED, N, "word");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
