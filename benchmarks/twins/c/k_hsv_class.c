/* Colour class by the largest and the smallest of three channels, and a table of hues. */
#include "ref.h"

#define SEED 1504u
#define N 300

KERNEL void hsv_class(const uint8_t r[], const uint8_t g[], const uint8_t b[], const uint8_t table[], uint8_t out[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t most = r[i];
        int32_t least = r[i];
        if (g[i] > most) {
            most = g[i];
        }
        if (b[i] > most) {
            most = b[i];
        }
        if (g[i] < least) {
            least = g[i];
        }
        if (b[i] < least) {
            least = b[i];
        }
        if (most - least < 32) {
            out[i] = 0;
        } else {
            out[i] = table[((most >> 4) << 4) | (least >> 4)];
        }
    }
}

int main(void)
{
    static uint8_t r[N], g[N], b[N], table[256], out[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        r[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        g[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        b[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 256; i++)
        table[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    hsv_class(r, g, b, table, out, N);
    CYC_READ(c1);

    h = fnv_u8(h, out, N);
    report("hsv_class", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
