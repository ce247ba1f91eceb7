/* Sums of all windows of a size, from a table of sums of the columns. */
#include "ref.h"

#define SEED 1228u
#define W 60
#define H 16
#define SIZE 5

KERNEL void window_sums(const uint8_t src[], uint16_t column[], uint16_t dst[], int32_t w, int32_t h, int32_t size)
{
    for (int32_t x = 0; x < w; x++) {
        column[x] = 0;
    }
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            column[x] += src[y * w + x];
            if (y >= size) {
                column[x] -= src[(y - size) * w + x];
            }
        }
        if (y >= size - 1) {
            int32_t sum = 0;
            for (int32_t x = 0; x < w; x++) {
                sum += column[x];
                if (x >= size) {
                    sum -= column[x - size];
                }
                dst[y * w + x] = (uint16_t)sum;
            }
        }
    }
}

int main(void)
{
    static uint8_t src[W * H];
    static uint16_t column[W], dst[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    window_sums(src, column, dst, W, H, SIZE);
    CYC_READ(c1);

    report("window_sums", c1 - c0, fnv_u16(FNV_INIT, dst, W * H));
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("size", SIZE);
    PARAMS_END();
    return 0;
}
