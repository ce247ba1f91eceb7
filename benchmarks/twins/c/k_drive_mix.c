/* Speeds of two wheels from a joystick: no jitter about the middle, no sudden steps. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2835u
#define N 160

static inline int32_t limit(int32_t value, int32_t low, int32_t high)
{
    if (value < low)
        return low;
    if (value > high)
        return high;
    return value;
}

HELPER int32_t dead_zone(int32_t value, int32_t width)
{
    if (value > width)
        return value - width;
    if (value < -width)
        return value + width;
    return 0;
}

KERNEL void drive_mix(const int16_t throttle[], const int16_t steer[], int32_t n, int32_t width, int32_t slew, int16_t left[],
                      int16_t right[])
{
    int32_t now_left = 0, now_right = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t ahead = dead_zone(throttle[i], width);
        int32_t turn = dead_zone(steer[i], width);
        turn = (turn * abs(turn)) >> 10;
        int32_t to_left = limit(ahead + turn, -1000, 1000);
        int32_t to_right = limit(ahead - turn, -1000, 1000);
        now_left += limit(to_left - now_left, -slew, slew);
        now_right += limit(to_right - now_right, -slew, slew);
        left[i] = now_left;
        right[i] = now_right;
    }
}

int main(void)
{
    static int16_t throttle[N], steer[N], left[N], right[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        throttle[i] = (int16_t)(lcg_below(&s, 2000) - 1000);
    for (int32_t i = 0; i < N; i++)
        steer[i] = (int16_t)(lcg_below(&s, 2000) - 1000);

    CYC_READ(c0);
    drive_mix(throttle, steer, N, 60, 150, left, right);
    CYC_READ(c1);

    h = fnv_i16(h, left, N);
    h = fnv_i16(h, right, N);
    report("drive_mix", c1 - c0, h);
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
