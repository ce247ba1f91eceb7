/* Semi-global matching along a row: paths with small and large steps of disparity; `paths` has a place more at either end. */
#include "ref.h"

#define SEED 3003u
#define N 48
#define DEPTH 16
#define MIN(a, b) ((a) < (b) ? (a) : (b))

KERNEL void sgm_row(const uint8_t *costs, int32_t n, int32_t depth, int32_t small, int32_t large, uint16_t *paths, uint16_t *sums,
                    uint8_t *best)
{
    int32_t least = 0;

    for (int32_t d = 1; d <= depth; d++)
        paths[d] = 0;
    paths[0] = paths[depth + 1] = UINT16_MAX;

    while (n-- > 0) {
        uint16_t *path = paths + 1;
        int32_t before = UINT16_MAX, next_least = UINT16_MAX, lowest = UINT16_MAX, choice = 0;
        for (int32_t d = 0; d < depth; d++, path++, sums++) {
            int32_t same = path[0];
            int32_t step = MIN(before, path[1]) + small;
            int32_t cost = MIN(same, step);
            cost = MIN(cost, least + large) - least + *costs++;
            before = same;
            *path = cost;
            next_least = MIN(next_least, cost);
            *sums += cost;
            if (*sums < lowest) {
                lowest = *sums;
                choice = d;
            }
        }
        *best++ = choice;
        least = next_least;
    }
}

int main(void)
{
    static uint8_t costs[N][DEPTH], best[N];
    static uint16_t sums[N][DEPTH], paths[DEPTH + 2];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t x = 0; x < N; x++) {
        int32_t disparity = x < 20 ? 4 : 9;
        for (int32_t d = 0; d < DEPTH; d++) {
            costs[x][d] = 6 * (d < disparity ? disparity - d : d - disparity) + lcg_below(&s, 60);
            sums[x][d] = lcg_below(&s, 200);
        }
    }

    CYC_READ(c0);
    sgm_row(costs[0], N, DEPTH, 10, 60, paths, sums[0], best);
    CYC_READ(c1);

    h = fnv_u8(h, best, N);
    h = fnv_u16(h, sums[0], N * DEPTH);
    report("sgm_row", c1 - c0, h);
    PARAMS(SEED, N * DEPTH, "cost");
    PARAM("n", N);
    PARAM("depth", DEPTH);
    PARAMS_END();
    return 0;
}
