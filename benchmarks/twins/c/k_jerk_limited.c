/* An axis to one target after the other, with limits of speed, acceleration and jerk; how many it reached. */
#include "ref.h"
#include <stdlib.h>

#define SEED 3031u
#define TARGETS 5
#define TICKS 400
#define FASTEST 900
#define STRONGEST 40
#define JERK 9

struct axis {
    int32_t position, speed, acceleration;
};

static inline int32_t within(int32_t value, int32_t limit)
{
    if (value > limit)
        return limit;
    if (value < -limit)
        return -limit;
    return value;
}

HELPER int32_t newton_root(int32_t v)
{
    if (v < 2)
        return v > 0 ? v : 0;
    int32_t root = 1;
    for (int32_t left = v; left > 3; left >>= 2)
        root <<= 1;
    root <<= 1;
    for (;;) {
        int32_t better = (root + v / root) >> 1;
        if (better >= root)
            return root;
        root = better;
    }
}

KERNEL int32_t jerk_limited(const int32_t *targets, int32_t n, int32_t ticks, int32_t *positions)
{
    struct axis axis = {0, 0, 0};
    int32_t goal = 0;

    for (int32_t tick = 0; tick < ticks; tick++) {
        int32_t left = targets[goal] - axis.position;
        int32_t distance = abs(left);
        if (distance < 16 && abs(axis.speed) < 8) {
            axis.speed = axis.acceleration = 0;
            if (++goal == n)
                break;
        } else {
            int32_t wanted = newton_root(16 * distance);
            if (wanted > (distance >> 3) + 4)
                wanted = (distance >> 3) + 4;
            if (wanted > FASTEST)
                wanted = FASTEST;
            if (left < 0)
                wanted = -wanted;
            int32_t push = within((wanted - axis.speed) >> 2, STRONGEST);
            axis.acceleration += within(push - axis.acceleration, JERK);
            axis.speed += axis.acceleration;
            axis.position += axis.speed;
        }
        positions[tick] = axis.position;
    }
    return goal;
}

int main(void)
{
    static int32_t targets[TARGETS], positions[TICKS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < TARGETS; i++)
        targets[i] = lcg_below(&s, 40001) - 20000;

    CYC_READ(c0);
    int32_t reached = jerk_limited(targets, TARGETS, TICKS, positions);
    CYC_READ(c1);

    h = fnv_i32(h, positions, TICKS);
    h = fnv_i32(h, &reached, 1);
    report("jerk_limited", c1 - c0, h);
    PARAMS(SEED, TICKS, "tick");
    PARAM("targets", TARGETS);
    PARAMS_END();
    return 0;
}
