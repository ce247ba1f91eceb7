/* Steps of three motors along a straight line: bits 0 to 2 step, 3 to 5 are directions. */
#include "ref.h"

#define SEED 2836u
#define MOVES 6
#define MOST 100

KERNEL int32_t step_axes(int32_t dx, int32_t dy, int32_t dz, uint8_t port[])
{
    int32_t directions = 0;
    if (dx < 0) {
        dx = -dx;
        directions |= 8;
    }
    if (dy < 0) {
        dy = -dy;
        directions |= 16;
    }
    if (dz < 0) {
        dz = -dz;
        directions |= 32;
    }
    int32_t steps = dx;
    if (dy > steps)
        steps = dy;
    if (dz > steps)
        steps = dz;
    int32_t error_x = steps / 2, error_y = steps / 2, error_z = steps / 2;
    for (int32_t i = 0; i < steps; i++) {
        int32_t bits = directions;
        error_x -= dx;
        if (error_x < 0) {
            error_x += steps;
            bits |= 1;
        }
        error_y -= dy;
        if (error_y < 0) {
            error_y += steps;
            bits |= 2;
        }
        error_z -= dz;
        if (error_z < 0) {
            error_z += steps;
            bits |= 4;
        }
        port[i] = bits;
    }
    return steps;
}

int main(void)
{
    static uint8_t ports[MOVES * MOST];
    static int32_t moves[3 * MOVES];
    int32_t steps[MOVES];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 3 * MOVES; i++)
        moves[i] = lcg_below(&s, 201) - 100;

    CYC_READ(c0);
    for (int32_t i = 0; i < MOVES; i++)
        steps[i] = step_axes(moves[3 * i], moves[3 * i + 1], moves[3 * i + 2], ports + MOST * i);
    CYC_READ(c1);

    h = fnv_u8(h, ports, MOVES * MOST);
    h = fnv_i32(h, steps, MOVES);
    report("step_axes", c1 - c0, h);
    PARAMS(SEED, MOVES, "move");
    PARAM("moves", MOVES);
    PARAMS_END();
    return 0;
}
