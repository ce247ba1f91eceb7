/* Mean of the last rows, column by column, kept as sums of 16 bits. */
#include "ref.h"

#define SEED 1242u
#define W 50
#define H 16

KERNEL void column_means(const uint8_t src[], uint16_t sum[], uint8_t dst[], int32_t w, int32_t h, int32_t shift)
{
    int32_t rows = 1 << shift;
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            sum[x] += src[y * w + x];
            if (y >= rows) {
                sum[x] -= src[(y - rows) * w + x];
                dst[y * w + x] = (uint8_t)(sum[x] >> shift);
            }
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    static uint16_t sum[W];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    column_means(src, sum, dst, W, H, 2);
    CYC_READ(c1);

    report("column_means", c1 - c0, fnv_u8(FNV_INIT, dst, W * H));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
