/* Morton numbers: the bits of x and y interleaved, each spread by a function. */
#include "ref.h"

#define SEED 1108u
#define N 300

/* abcd -> 0a0b0c0d, for 16 bits */
HELPER uint32_t spread(uint32_t v)
{
    v = (v | (v << 8)) & 0x00FF00FFu;
    v = (v | (v << 4)) & 0x0F0F0F0Fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
}

KERNEL void morton(const uint16_t x[], const uint16_t y[], uint32_t code[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        code[i] = spread(x[i]) | (spread(y[i]) << 1);
    }
}

int main(void)
{
    static uint16_t x[N], y[N];
    static uint32_t code[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (uint16_t)lcg_u16(&s);
    for (int32_t i = 0; i < N; i++)
        y[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    morton(x, y, code, N);
    CYC_READ(c1);

    report("morton", c1 - c0, fnv_u32(FNV_INIT, code, N));
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
