/* The free sector nearest to the goal, among `n` around the robot; -1 if there is none. */
#include "ref.h"
#include <limits.h>
#include <stdlib.h>

#define SEED 2931u
#define SECTORS 72
#define FRAMES 8

/* Sectors between two, the short way round. */
static inline int32_t apart(int32_t a, int32_t b, int32_t n)
{
    int32_t d = abs(a - b);
    return d < n - d ? d : n - d;
}

KERNEL int32_t steer_clear(const uint16_t *ranges, int32_t n, int32_t reach, int32_t goal, int32_t heading, int32_t *density)
{
    for (int32_t s = 0; s < n; s++) {
        int32_t distance = ranges[s];
        if (distance > 0 && distance < reach) {
            int32_t near = reach - distance;
            density[s] = near * near >> 10;
        } else {
            density[s] = 0;
        }
    }
    int32_t best = -1, least = INT_MAX;
    for (int32_t s = 0; s < n; s++) {
        int32_t crowded = 2 * density[s];
        for (int32_t k = 1; k <= 2; k++) {
            int32_t after = s + k < n ? s + k : s + k - n;
            int32_t before = s - k >= 0 ? s - k : s - k + n;
            crowded += (density[after] + density[before]) >> (k - 1);
        }
        if (crowded > 1200)
            continue;
        int32_t cost = 5 * apart(s, goal, n) + 2 * apart(s, heading, n) + (crowded >> 6);
        if (cost < least) {
            least = cost;
            best = s;
        }
    }
    return best;
}

int main(void)
{
    static uint16_t ranges[FRAMES][SECTORS];
    static int32_t density[SECTORS];
    int32_t goals[FRAMES], headings[FRAMES], chosen[FRAMES];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t f = 0; f < FRAMES; f++) {
        for (int32_t i = 0; i < SECTORS; i++)
            ranges[f][i] = lcg_below(&s, 3000);
        for (int32_t i = 20 + f; i < 40; i++)
            ranges[f][i] = 2000 + lcg_below(&s, 500);
        goals[f] = lcg_below(&s, 72);
        headings[f] = lcg_below(&s, 72);
    }

    CYC_READ(c0);
    for (int32_t f = 0; f < FRAMES; f++)
        chosen[f] = steer_clear(ranges[f], SECTORS, 1800, goals[f], headings[f], density);
    CYC_READ(c1);

    h = fnv_i32(h, chosen, FRAMES);
    h = fnv_i32(h, density, SECTORS);
    report("steer_clear", c1 - c0, h);
    PARAMS(SEED, FRAMES * SECTORS, "sector");
    PARAM("n", SECTORS);
    PARAMS_END();
    return 0;
}
