/* Angle of vectors in 1/256 of a turn: octants, a division and a table. */
#include "ref.h"

#define SEED 1229u
#define N 200

KERNEL void atan2_table(const int16_t dx[], const int16_t dy[], const uint8_t table[], uint8_t out[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t x = dx[i];
        int32_t y = dy[i];
        uint32_t ax = (uint32_t)(x < 0 ? -x : x);
        uint32_t ay = (uint32_t)(y < 0 ? -y : y);
        int32_t angle = 0;
        if (ax >= ay) {
            if (ax > 0) {
                angle = table[(ay << 8) / ax];
            }
        } else {
            angle = 64 - table[(ax << 8) / ay];
        }
        if (x < 0) {
            angle = 128 - angle;
        }
        if (y < 0) {
            angle = -angle;
        }
        out[i] = (uint8_t)(angle & 255);
    }
}

int main(void)
{
    static int16_t dx[N], dy[N];
    static uint8_t out[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        dx[i] = (int16_t)(lcg_below(&s, 2001) - 1000);
    for (int32_t i = 0; i < N; i++)
        dy[i] = (int16_t)(lcg_below(&s, 2001) - 1000);

    CYC_READ(c0);
    atan2_table(dx, dy, ATAN257, out, N);
    CYC_READ(c1);

    report("atan2_table", c1 - c0, fnv_u8(FNV_INIT, out, N));
    PARAMS(SEED, N, "vector");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
