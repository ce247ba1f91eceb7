/* Base-64 without line breaks, padded with '='. Returns the length. */
#include "ref.h"

#define SEED 1305u
#define N 500

KERNEL int32_t base64_encode(const uint8_t src[], int32_t n, const uint8_t digits[], uint8_t dst[])
{
    int32_t o = 0;
    int32_t i = 0;
    while (i + 2 < n) {
        int32_t v = (src[i] << 16) | (src[i + 1] << 8) | src[i + 2];
        dst[o] = digits[v >> 18];
        dst[o + 1] = digits[(v >> 12) & 63];
        dst[o + 2] = digits[(v >> 6) & 63];
        dst[o + 3] = digits[v & 63];
        i += 3;
        o += 4;
    }
    if (i < n) {
        int32_t v = src[i] << 16;
        if (i + 1 < n) {
            v |= src[i + 1] << 8;
        }
        dst[o] = digits[v >> 18];
        dst[o + 1] = digits[(v >> 12) & 63];
        if (i + 1 < n) {
            dst[o + 2] = digits[(v >> 6) & 63];
        } else {
            dst[o + 2] = 61;
        }
        dst[o + 3] = 61;
        o += 4;
    }
    return o;
}

int main(void)
{
    static uint8_t src[N], digits[64], dst[2 * N];
    int32_t length;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 64; i++)
        digits[i] = (uint8_t)(33 + i);

    CYC_READ(c0);
    length = base64_encode(src, N, digits, dst);
    CYC_READ(c1);

    h = fnv_u8(h, dst, 2 * N);
    h = fnv_val32(h, (uint32_t)length);
    report("base64_encode", c1 - c0, h);
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
