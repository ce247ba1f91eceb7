/* Picture of edges: where the sum of both absolute Sobel gradients reaches a threshold. */
#include "ref.h"

#define SEED 1225u
#define W 48
#define H 20
#define THRESHOLD 300

KERNEL int32_t sobel_binary(const uint8_t src[], uint8_t dst[], int32_t w, int32_t h, int32_t threshold)
{
    int32_t edges = 0;
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t p = y * w + x;
            int32_t gx = src[p - w + 1] - src[p - w - 1] + 2 * (src[p + 1] - src[p - 1]) + src[p + w + 1]
                         - src[p + w - 1];
            int32_t gy = src[p + w - 1] + 2 * src[p + w] + src[p + w + 1] - src[p - w - 1] - 2 * src[p - w]
                         - src[p - w + 1];
            if (gx < 0) {
                gx = -gx;
            }
            if (gy < 0) {
                gy = -gy;
            }
            if (gx + gy >= threshold) {
                dst[p] = 255;
                edges++;
            } else {
                dst[p] = 0;
            }
        }
    }
    return edges;
}

int main(void)
{
    static uint8_t src[W * H], dst[W * H];
    int32_t edges;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    edges = sobel_binary(src, dst, W, H, THRESHOLD);
    CYC_READ(c1);

    h = fnv_u8(h, dst, W * H);
    h = fnv_val32(h, (uint32_t)edges);
    report("sobel_binary", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("threshold", THRESHOLD);
    PARAMS_END();
    return 0;
}
