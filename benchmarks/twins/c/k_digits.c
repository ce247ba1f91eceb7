/* Unsigned numbers as text, right-justified in fields of `width` characters. */
#include "ref.h"

#define SEED 1145u
#define N 30
#define WIDTH 10

KERNEL void digits(const uint32_t values[], int32_t n, uint8_t text[], int32_t width)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t v = values[i];
        int32_t p = (i + 1) * width - 1;
        text[p] = (uint8_t)(48u + v % 10u);
        v = v / 10u;
        for (int32_t k = 1; k < width; k++) {
            p = p - 1;
            if (v == 0) {
                text[p] = 32;
            } else {
                text[p] = (uint8_t)(48u + v % 10u);
                v = v / 10u;
            }
        }
    }
}

int main(void)
{
    static uint32_t values[N];
    static uint8_t text[N * WIDTH];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* shifted right by the number of the value, modulo 32 */
    for (int32_t i = 0; i < N; i++)
        values[i] = lcg_next(&s) >> (i & 31);

    CYC_READ(c0);
    digits(values, N, text, WIDTH);
    CYC_READ(c1);

    report("digits", c1 - c0, fnv_u8(FNV_INIT, text, N * WIDTH));
    PARAMS(SEED, N, "number");
    PARAM("n", N);
    PARAM("width", WIDTH);
    PARAMS_END();
    return 0;
}
