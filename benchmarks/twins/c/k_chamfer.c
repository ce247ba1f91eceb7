/* Distance transform by 3-4 chamfer masks: a forward and a backward pass; the border stays as it is. */
#include "ref.h"

#define SEED 1134u
#define W 32
#define H 24

KERNEL void chamfer(uint8_t dist[], int32_t w, int32_t h)
{
    for (int32_t y = 1; y < h - 1; y++) {
        for (int32_t x = 1; x < w - 1; x++) {
            int32_t p = y * w + x;
            int32_t d = dist[p];
            if (d != 0) {
                int32_t side = dist[p - 1] < dist[p - w] ? dist[p - 1] : dist[p - w];
                int32_t corner = dist[p - w - 1] < dist[p - w + 1] ? dist[p - w - 1] : dist[p - w + 1];
                side += 3;
                corner += 4;
                d = side < d ? side : d;
                d = corner < d ? corner : d;
                dist[p] = (uint8_t)d;
            }
        }
    }
    for (int32_t y = h - 2; y > 0; y--) {
        for (int32_t x = w - 2; x > 0; x--) {
            int32_t p = y * w + x;
            int32_t d = dist[p];
            if (d != 0) {
                int32_t side = dist[p + 1] < dist[p + w] ? dist[p + 1] : dist[p + w];
                int32_t corner = dist[p + w + 1] < dist[p + w - 1] ? dist[p + w + 1] : dist[p + w - 1];
                side += 3;
                corner += 4;
                d = side < d ? side : d;
                d = corner < d ? corner : d;
                dist[p] = (uint8_t)d;
            }
        }
    }
}

int main(void)
{
    static uint8_t dist[W * H];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* one draw per pixel: an object where the byte is below 12, else far away */
    for (int32_t i = 0; i < W * H; i++)
        dist[i] = (uint8_t)(lcg_u8(&s) < 12 ? 0 : 255);

    CYC_READ(c0);
    chamfer(dist, W, H);
    CYC_READ(c1);

    report("chamfer", c1 - c0, fnv_u8(FNV_INIT, dist, W * H));
    PARAMS(SEED, W*H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
