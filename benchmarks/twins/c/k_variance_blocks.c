/* Variance of every 8 x 8 block from the sum and the sum of squares. */
#include "ref.h"

#define SEED 1130u
#define W 64
#define H 32

KERNEL void variance_blocks(const uint8_t src[], int32_t w, int32_t h, uint16_t out[])
{
    int32_t k = 0;
    for (int32_t y0 = 0; y0 < h; y0 += 8) {
        for (int32_t x0 = 0; x0 < w; x0 += 8) {
            int32_t sum = 0;
            int32_t squares = 0;
            for (int32_t y = y0; y < y0 + 8; y++) {
                for (int32_t x = x0; x < x0 + 8; x++) {
                    int32_t v = src[y * w + x];
                    sum += v;
                    squares += v * v;
                }
            }
            out[k] = (uint16_t)((squares - ((sum * sum) >> 6)) >> 6);
            k++;
        }
    }
}

int main(void)
{
    static uint8_t src[W * H];
    static uint16_t out[W * H / 64];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    variance_blocks(src, W, H, out);
    CYC_READ(c1);

    report("variance_blocks", c1 - c0, fnv_u16(FNV_INIT, out, W * H / 64));
    PARAMS(SEED, W*H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
