/* Colour classes by a 32 x 32 table over two chroma values, and how often each class occurs. */
#include "ref.h"

#define SEED 1102u
#define N 1000
#define CLASSES 8

KERNEL void lut2d(const uint8_t u[], const uint8_t v[], const uint8_t lut[], uint8_t cls[],
                  uint16_t count[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t k = (u[i] >> 3) * 32 + (v[i] >> 3);
        int32_t c = lut[k];
        cls[i] = (uint8_t)c;
        count[c] = (uint16_t)(count[c] + 1);
    }
}

int main(void)
{
    static uint8_t u[N], v[N], lut[1024], cls[N];
    static uint16_t count[CLASSES];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        u[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        v[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 1024; i++)
        lut[i] = (uint8_t)lcg_below(&s, CLASSES);

    CYC_READ(c0);
    lut2d(u, v, lut, cls, count, N);
    CYC_READ(c1);

    h = fnv_u8(h, cls, N);
    h = fnv_u16(h, count, CLASSES);
    report("lut2d", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAM("classes", CLASSES);
    PARAMS_END();
    return 0;
}
