/* The ten moments up to the third order of a w x h patch, its darkest and its
 * brightest pixel: many values live at once. */
#include "ref.h"

#define SEED 1149u
#define W 24
#define H 20

KERNEL void moments(const uint8_t patch[], int32_t w, int32_t h, int32_t out[])
{
    int32_t m00 = 0, m10 = 0, m01 = 0, m11 = 0, m20 = 0, m02 = 0, m30 = 0, m21 = 0, m12 = 0, m03 = 0;
    int32_t dark = 255;
    int32_t bright = 0;
    int32_t p = 0;
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            int32_t v = patch[p];
            int32_t xv = x * v;
            int32_t yv = y * v;
            m00 += v;
            m10 += xv;
            m01 += yv;
            m11 += x * yv;
            m20 += x * xv;
            m02 += y * yv;
            m30 += x * x * xv;
            m21 += x * x * yv;
            m12 += y * y * xv;
            m03 += y * y * yv;
            dark = v < dark ? v : dark;
            bright = v > bright ? v : bright;
            p++;
        }
    }
    out[0] = m00;
    out[1] = m10;
    out[2] = m01;
    out[3] = m11;
    out[4] = m20;
    out[5] = m02;
    out[6] = m30;
    out[7] = m21;
    out[8] = m12;
    out[9] = m03;
    out[10] = dark;
    out[11] = bright;
}

int main(void)
{
    static uint8_t patch[W * H];
    static int32_t out[12];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        patch[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    moments(patch, W, H, out);
    CYC_READ(c1);

    report("moments", c1 - c0, fnv_i32(FNV_INIT, out, 12));
    PARAMS(SEED, W*H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
