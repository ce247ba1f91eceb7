/* One step of Lucas and Kanade about a point, 9 x 9: its shift in 256ths of a pixel; 0 where there is no corner. */
#include "ref.h"

#define SEED 2901u
#define W 64
#define H 48
#define POINTS 16

static inline int32_t clamp(int32_t value, int32_t limit)
{
    return value < -limit ? -limit : value > limit ? limit : value;
}

KERNEL int32_t flow_step(const uint8_t *before, const uint8_t *after, int32_t w, int32_t x, int32_t y, int32_t flow[2])
{
    int32_t xx = 0, xy = 0, yy = 0, xt = 0, yt = 0;
    for (int32_t j = -4; j <= 4; j++) {
        const uint8_t *b = before + (y + j) * w + x - 4;
        const uint8_t *a = after + (y + j) * w + x - 4;
        for (int32_t i = 0; i < 9; i++) {
            int32_t gx = (b[i + 1] - b[i - 1]) >> 1;
            int32_t gy = (b[i + w] - b[i - w]) >> 1;
            int32_t gt = a[i] - b[i];
            xx += gx * gx;
            xy += gx * gy;
            yy += gy * gy;
            xt += gx * gt;
            yt += gy * gt;
        }
    }
    xx >>= 7;
    xy >>= 7;
    yy >>= 7;
    xt >>= 7;
    yt >>= 7;
    int32_t determinant = xx * yy - xy * xy;
    if (determinant < 2048)
        return 0;
    determinant >>= 8;
    flow[0] = clamp((xy * yt - yy * xt) / determinant, 1024);
    flow[1] = clamp((xy * xt - xx * yt) / determinant, 1024);
    return 1;
}

int main(void)
{
    static uint8_t levels[(H / 4 + 1) * (W / 4 + 1)], before[W * H], after[W * H];
    static int32_t flow[2 * POINTS], corners[POINTS], xs[POINTS], ys[POINTS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < (H / 4 + 1) * (W / 4 + 1); i++)
        levels[i] = (uint8_t)lcg_u8(&s);
    for (int32_t y = 0; y < H; y++) {
        for (int32_t x = 0; x < W; x++) {
            const uint8_t *l = levels + (y / 4) * (W / 4 + 1) + x / 4;
            int32_t u = x & 3, v = y & 3;
            int32_t upper = l[0] * (4 - u) + l[1] * u;
            int32_t lower = l[W / 4 + 1] * (4 - u) + l[W / 4 + 2] * u;
            before[y * W + x] = (upper * (4 - v) + lower * v) >> 4;
        }
    }
    for (int32_t i = 0; i < W * H; i++)
        after[i] = i < W || i % W == 0 ? before[i] : (before[i - 1] + before[i - W]) >> 1;
    for (int32_t i = 0; i < POINTS; i++) {
        xs[i] = 5 + lcg_below(&s, 54);
        ys[i] = 5 + lcg_below(&s, 38);
    }

    CYC_READ(c0);
    for (int32_t i = 0; i < POINTS; i++)
        corners[i] = flow_step(before, after, W, xs[i], ys[i], flow + 2 * i);
    CYC_READ(c1);

    h = fnv_i32(h, flow, 2 * POINTS);
    h = fnv_i32(h, corners, POINTS);
    report("flow_step", c1 - c0, h);
    PARAMS(SEED, POINTS, "point");
    PARAM("w", W);
    PARAMS_END();
    return 0;
}
