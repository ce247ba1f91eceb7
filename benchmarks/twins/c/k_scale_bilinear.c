/* An image scaled to another size, bilinear, with coordinates in 1/256ths. */
#include "ref.h"

#define SEED 1310u
#define W 24
#define H 18
#define OW 32
#define OH 20

KERNEL void scale_bilinear(const uint8_t src[], int32_t w, int32_t sx, int32_t sy, uint8_t dst[], int32_t ow, int32_t oh)
{
    for (int32_t y = 0; y < oh; y++) {
        int32_t v = y * sy;
        int32_t fy = v & 255;
        int32_t row = (v >> 8) * w;
        for (int32_t x = 0; x < ow; x++) {
            int32_t u = x * sx;
            int32_t fx = u & 255;
            int32_t p = row + (u >> 8);
            int32_t top = (src[p] << 8) + (src[p + 1] - src[p]) * fx;
            int32_t bottom = (src[p + w] << 8) + (src[p + w + 1] - src[p + w]) * fx;
            dst[y * ow + x] = (uint8_t)((top * (256 - fy) + bottom * fy) >> 16);
        }
    }
}

int main(void)
{
    static uint8_t src[W * H], dst[OW * OH];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    scale_bilinear(src, W, (W - 1) * 256 / OW, (H - 1) * 256 / OH, dst, OW, OH);
    CYC_READ(c1);

    h = fnv_u8(h, dst, OW * OH);
    report("scale_bilinear", c1 - c0, h);
    PARAMS(SEED, OW * OH, "pixel");
    PARAM("w", OW);
    PARAM("h", OH);
    PARAMS_END();
    return 0;
}
