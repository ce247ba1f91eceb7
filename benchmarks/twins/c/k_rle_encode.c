/* Run-length encoding of a buffer: pairs of length (1..255) and value.  Returns
 * the number of bytes written. */
#include "ref.h"

#define SEED 1137u
#define N 1500

KERNEL int32_t rle_encode(const uint8_t src[], int32_t n, uint8_t out[])
{
    int32_t i = 0;
    int32_t k = 0;
    while (i < n) {
        int32_t v = src[i];
        int32_t run = 1;
        while (i + run < n && run < 255 && src[i + run] == v) {
            run++;
        }
        out[k] = (uint8_t)run;
        out[k + 1] = (uint8_t)v;
        k += 2;
        i += run;
    }
    return k;
}

int main(void)
{
    static uint8_t src[N], out[2 * N];
    int32_t size, v = 0;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* one draw per byte; below 40 it is followed by another, which gives a new value 0..3 */
    for (int32_t i = 0; i < N; i++) {
        if (lcg_u8(&s) < 40)
            v = lcg_u8(&s) >> 6;
        src[i] = (uint8_t)v;
    }

    CYC_READ(c0);
    size = rle_encode(src, N, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, size);
    h = fnv_val32(h, (uint32_t)size);
    report("rle_encode", c1 - c0, h);
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
