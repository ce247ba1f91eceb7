/* Box filter of 2 * radius + 1 pixels with a running sum; scale is 65536 / width, rounded up. */
#include "ref.h"

#define SEED 1127u
#define N 1024
#define RADIUS 4
#define SCALE 7282

KERNEL void box_running(const uint8_t src[], uint8_t dst[], int32_t n, int32_t radius, int32_t scale)
{
    int32_t sum = 0;
    for (int32_t i = 0; i < 2 * radius + 1; i++) {
        sum += src[i];
    }
    int32_t last = n - radius - 1;
    for (int32_t i = radius; i < last; i++) {
        dst[i] = (uint8_t)((sum * scale) >> 16);
        sum = sum + src[i + radius + 1] - src[i - radius];
    }
    dst[last] = (uint8_t)((sum * scale) >> 16);
}

int main(void)
{
    static uint8_t src[N], dst[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    box_running(src, dst, N, RADIUS, SCALE);
    CYC_READ(c1);

    report("box_running", c1 - c0, fnv_u8(FNV_INIT, dst, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAM("radius", RADIUS);
    PARAM("scale", SCALE);
    PARAMS_END();
    return 0;
}
