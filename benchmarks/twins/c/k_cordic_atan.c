/* Directions of N vectors by CORDIC: 65536 is a full turn.  step[k] is
 * floor(atan(2^-k) * 32768 / pi + 0.5). */
#include "ref.h"

#define SEED 1143u
#define N 64
#define STEPS 14

KERNEL void cordic_atan(const int16_t vx[], const int16_t vy[], const int16_t step[], int32_t steps,
                        uint16_t angle[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t x = vx[i] * 256;
        int32_t y = vy[i] * 256;
        int32_t a = 0;
        if (x < 0) {
            x = -x;
            y = -y;
            a = 32768;
        }
        for (int32_t k = 0; k < steps; k++) {
            int32_t xs = x >> k;
            int32_t ys = y >> k;
            if (y > 0) {
                x = x + ys;
                y = y - xs;
                a = a + step[k];
            } else {
                x = x - ys;
                y = y + xs;
                a = a - step[k];
            }
        }
        angle[i] = (uint16_t)(a & 65535);
    }
}

int main(void)
{
    static const int16_t step[STEPS] = {8192, 4836, 2555, 1297, 651, 326, 163, 81, 41, 20, 10, 5, 3, 1};
    static int16_t vx[N], vy[N];
    static uint16_t angle[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* two draws per vector: x and y in -1020 .. 1020 */
    for (int32_t i = 0; i < N; i++) {
        vx[i] = (int16_t)(lcg_below(&s, 2041) - 1020);
        vy[i] = (int16_t)(lcg_below(&s, 2041) - 1020);
    }

    CYC_READ(c0);
    cordic_atan(vx, vy, step, STEPS, angle, N);
    CYC_READ(c1);

    report("cordic_atan", c1 - c0, fnv_u16(FNV_INIT, angle, N));
    PARAMS(SEED, N, "angle");
    PARAM("n", N);
    PARAM("steps", STEPS);
    PARAMS_END();
    return 0;
}
