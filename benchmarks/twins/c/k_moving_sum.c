/* Sum of the last values of a row, for several rows. */
#include "ref.h"

#define SEED 1246u
#define W 60
#define H 10
#define SIZE 7

KERNEL void moving_sum(const int16_t src[], int32_t dst[], int32_t w, int32_t h, int32_t size)
{
    for (int32_t y = 0; y < h; y++) {
        int32_t sum = 0;
        for (int32_t x = 0; x < w; x++) {
            sum += src[y * w + x];
            if (x >= size) {
                sum -= src[y * w + x - size];
            }
            dst[y * w + x] = sum;
        }
    }
}

int main(void)
{
    static int16_t src[W * H];
    static int32_t dst[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (int16_t)(lcg_below(&s, 2000) - 1000);

    CYC_READ(c0);
    moving_sum(src, dst, W, H, SIZE);
    CYC_READ(c1);

    report("moving_sum", c1 - c0, fnv_i32(FNV_INIT, dst, W * H));
    PARAMS(SEED, W * H, "value");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("size", SIZE);
    PARAMS_END();
    return 0;
}
