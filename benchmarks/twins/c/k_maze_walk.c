/* Walk along the right-hand wall until the goal or the limit; counts the visits of
 * every cell and returns the steps. */
#include "ref.h"

#define SEED 1138u
#define W 30
#define H 20
#define START 31
#define GOAL 568
#define LIMIT 1000

KERNEL int32_t maze_walk(const uint8_t wall[], const int16_t offset[], int32_t p, int32_t goal,
                         int32_t limit, uint8_t visits[])
{
    int32_t steps = 0;
    int32_t d = 0;
    while (p != goal && steps < limit) {
        d = (d + 1) & 3;
        while (wall[p + offset[d]] != 0) {
            d = (d - 1) & 3;
        }
        p = p + offset[d];
        visits[p] = (uint8_t)((visits[p] + 1) & 255);
        steps = steps + 1;
    }
    return steps;
}

int main(void)
{
    static const int16_t offset[4] = {1, W, -1, -W};
    static uint8_t wall[W * H], visits[W * H];
    int32_t steps;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* one draw per cell: a wall where the byte is above 150, and on the border */
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++) {
            int32_t high = lcg_u8(&s) > 150;
            wall[y * W + x] = (uint8_t)(high || x == 0 || y == 0 || x == W - 1 || y == H - 1);
        }
    wall[START] = 0;
    wall[START + 1] = 0;

    CYC_READ(c0);
    steps = maze_walk(wall, offset, START, GOAL, LIMIT, visits);
    CYC_READ(c1);

    h = fnv_u8(h, visits, W * H);
    h = fnv_val32(h, (uint32_t)steps);
    report("maze_walk", c1 - c0, h);
    PARAMS(SEED, steps, "step");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("start", START);
    PARAM("goal", GOAL);
    PARAM("limit", LIMIT);
    PARAMS_END();
    return 0;
}
