/* Pulses of eight servos in microseconds: each comes to its target without a jerk. */
#include "ref.h"

#define SEED 2924u
#define FRAMES 50
#define SERVOS 8

static inline int32_t limit(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

KERNEL void servo_frames(const int16_t targets[], int32_t n, const int16_t trims[], const uint8_t turned[], int16_t positions[],
                         int16_t speeds[], uint16_t *ticks)
{
    for (int32_t frame = 0; frame < n; frame++) {
        for (int32_t c = 0; c < SERVOS; c++) {
            int32_t wanted = limit((targets[c] - positions[c]) >> 2, -60, 60);
            speeds[c] += limit(wanted - speeds[c], -8, 8);
            positions[c] += speeds[c];
            int32_t pulse = 1500 + trims[c];
            if (turned[c])
                pulse -= positions[c];
            else
                pulse += positions[c];
            *ticks++ = limit(pulse, 900, 2100);
        }
    }
}

int main(void)
{
    static int16_t targets[SERVOS], trims[SERVOS], positions[SERVOS], speeds[SERVOS];
    static uint8_t turned[SERVOS];
    static uint16_t ticks[FRAMES * SERVOS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t c = 0; c < SERVOS; c++)
        targets[c] = lcg_below(&s, 1201) - 600;
    for (int32_t c = 0; c < SERVOS; c++)
        trims[c] = lcg_below(&s, 81) - 40;
    for (int32_t c = 0; c < SERVOS; c++)
        turned[c] = lcg_below(&s, 2);

    CYC_READ(c0);
    servo_frames(targets, FRAMES, trims, turned, positions, speeds, ticks);
    CYC_READ(c1);

    h = fnv_u16(h, ticks, FRAMES * SERVOS);
    h = fnv_i16(h, positions, SERVOS);
    report("servo_frames", c1 - c0, h);
    PARAMS(SEED, FRAMES * SERVOS, "pulse");
    PARAM("frames", FRAMES);
    PARAMS_END();
    return 0;
}
