/* Transposed copy of a picture of bytes. */
#include "ref.h"

#define SEED 1203u
#define W 48
#define H 32

KERNEL void transpose_u8(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h)
{
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            dst[x * h + y] = src[y * w + x];
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    transpose_u8(src, dst, W, H);
    CYC_READ(c1);

    report("transpose_u8", c1 - c0, fnv_u8(FNV_INIT, dst, W * H));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
