/* Turn a quaternion by `n` rates about three axes; 14 fractional bits, and its length is kept near one. */
#include "ref.h"

#define SEED 2921u
#define N 100
#define ONE 16384

struct rates {
    int16_t roll, pitch, yaw;
};

struct quaternion {
    int32_t w, x, y, z;
};

KERNEL void quaternion_track(const struct rates rates[], int32_t n, struct quaternion *q)
{
    int32_t w = q->w, x = q->x, y = q->y, z = q->z;
    for (int32_t i = 0; i < n; i++) {
        int32_t roll = rates[i].roll, pitch = rates[i].pitch, yaw = rates[i].yaw;
        int32_t nw = w - ((x * roll + y * pitch + z * yaw) >> 16);
        int32_t nx = x + ((w * roll + y * yaw - z * pitch) >> 16);
        int32_t ny = y + ((w * pitch - x * yaw + z * roll) >> 16);
        int32_t nz = z + ((w * yaw + x * pitch - y * roll) >> 16);
        int32_t norm = (nw * nw + nx * nx + ny * ny + nz * nz) >> 14;
        int32_t scale = (3 * ONE - norm) >> 1;
        w = nw * scale >> 14;
        x = nx * scale >> 14;
        y = ny * scale >> 14;
        z = nz * scale >> 14;
    }
    q->w = w;
    q->x = x;
    q->y = y;
    q->z = z;
}

int main(void)
{
    static struct rates rates[N];
    struct quaternion q = {ONE, 0, 0, 0};
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        rates[i].roll = lcg_below(&s, 4001) - 2000;
        rates[i].pitch = lcg_below(&s, 4001) - 2000;
        rates[i].yaw = lcg_below(&s, 4001) - 2000;
    }

    CYC_READ(c0);
    quaternion_track(rates, N, &q);
    CYC_READ(c1);

    h = fnv_i32(h, &q.w, 4);
    report("quaternion_track", c1 - c0, h);
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
