/* Which of `m` things is which of `n` tracks, at the least cost in all (Hungarian); track[j] is 0 for none. */
#include "ref.h"
#include <stdbool.h>
#include <string.h>

#define SEED 3034u
#define TRACKS 8
#define THINGS 10
#define FRAMES 3
#define FAR 0x3FFFFFFF

KERNEL int32_t assign_tracks(const uint16_t *costs, int32_t n, int32_t m, uint8_t *track)
{
    int32_t rows[TRACKS + 1], columns[THINGS + 1], least[THINGS + 1];
    uint8_t way[THINGS + 1];
    bool seen[THINGS + 1];

    memset(rows, 0, (n + 1) * sizeof *rows);
    memset(columns, 0, (m + 1) * sizeof *columns);
    memset(track, 0, m + 1);
    for (int32_t i = 1; i <= n; i++) {
        int32_t j = 0;
        track[0] = i;
        for (int32_t k = 0; k <= m; k++) {
            least[k] = FAR;
            seen[k] = false;
        }
        do {
            int32_t row = track[j], smallest = FAR, nearest = 0;
            const uint16_t *cost = costs + (row - 1) * m;
            seen[j] = true;
            for (int32_t k = 1; k <= m; k++, cost++) {
                if (seen[k])
                    continue;
                int32_t reduced = *cost - rows[row] - columns[k];
                if (reduced < least[k]) {
                    least[k] = reduced;
                    way[k] = j;
                }
                if (least[k] < smallest) {
                    smallest = least[k];
                    nearest = k;
                }
            }
            for (int32_t k = 0; k <= m; k++) {
                if (seen[k]) {
                    rows[track[k]] += smallest;
                    columns[k] -= smallest;
                } else {
                    least[k] -= smallest;
                }
            }
            j = nearest;
        } while (track[j]);

        while (j) {
            int32_t before = way[j];
            track[j] = track[before];
            j = before;
        }
    }
    return -columns[0];
}

int main(void)
{
    static uint16_t costs[TRACKS * THINGS];
    static uint8_t tracks[FRAMES][THINGS + 1];
    static int32_t totals[FRAMES];
    uint32_t s = SEED, c0, c1, cycles = 0, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t frame = 0; frame < FRAMES; frame++) {
        for (int32_t i = 0; i < TRACKS * THINGS; i++)
            costs[i] = lcg_below(&s, 1000) + 20;
        CYC_READ(c0);
        totals[frame] = assign_tracks(costs, TRACKS, THINGS, tracks[frame]);
        CYC_READ(c1);
        cycles += c1 - c0;
    }

    h = fnv_u8(h, tracks[0], FRAMES * (THINGS + 1));
    h = fnv_i32(h, totals, FRAMES);
    report("assign_tracks", cycles, h);
    PARAMS(SEED, FRAMES * TRACKS, "track");
    PARAM("tracks", TRACKS);
    PARAM("things", THINGS);
    PARAMS_END();
    return 0;
}
