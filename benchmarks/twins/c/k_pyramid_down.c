/* Half the size after 1 4 6 4 1 both ways; `line` has two more pixels at either end. */
#include "ref.h"

#define SEED 2902u
#define W 80
#define H 48

KERNEL void pyramid_down(const uint8_t *image, int32_t w, int32_t h, int16_t *line, uint8_t *out)
{
    for (int32_t y = 0; y < h; y += 2) {
        const uint8_t *a2 = image + w * (y >= 2 ? y - 2 : 0);
        const uint8_t *a = image + w * (y >= 1 ? y - 1 : 0);
        const uint8_t *p = image + w * y;
        const uint8_t *b = image + w * (y + 1 < h ? y + 1 : h - 1);
        const uint8_t *b2 = image + w * (y + 2 < h ? y + 2 : h - 1);
        for (int32_t x = 0; x < w; x++)
            line[x + 2] = a2[x] + 4 * (a[x] + b[x]) + 6 * p[x] + b2[x];
        line[0] = line[1] = line[2];
        line[w + 2] = line[w + 3] = line[w + 1];
        const int16_t *l = line;
        for (int32_t x = 0; x < w; x += 2, l += 2)
            *out++ = (l[0] + 4 * (l[1] + l[3]) + 6 * l[2] + l[4] + 128) >> 8;
    }
}

int main(void)
{
    static uint8_t image[W * H], out[W / 2 * H / 2];
    static int16_t line[W + 4];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    pyramid_down(image, W, H, line, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, W / 2 * H / 2);
    report("pyramid_down", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
