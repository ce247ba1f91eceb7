/* Breadth-first search on a grid of walls (non-zero): steps from the start to
 * every cell, -1 where there is no way.  Returns the number of cells reached. */
#include "ref.h"

#define SEED 1139u
#define W 40
#define H 30
#define START 41

KERNEL int32_t grid_bfs(const uint8_t wall[], int32_t cells, int32_t start, const int16_t offset[],
                        int16_t dist[], uint16_t queue[])
{
    for (int32_t i = 0; i < cells; i++) {
        dist[i] = -1;
    }
    int32_t head = 0;
    int32_t tail = 1;
    queue[0] = (uint16_t)start;
    dist[start] = 0;
    while (head < tail) {
        int32_t p = queue[head];
        int32_t next = dist[p] + 1;
        head = head + 1;
        for (int32_t d = 0; d < 4; d++) {
            int32_t q = p + offset[d];
            if (wall[q] != 0 || dist[q] >= 0) {
                continue;
            }
            dist[q] = (int16_t)next;
            queue[tail] = (uint16_t)q;
            tail = tail + 1;
        }
    }
    return tail;
}

int main(void)
{
    static const int16_t offset[4] = {1, W, -1, -W};
    static uint8_t wall[W * H];
    static int16_t dist[W * H];
    static uint16_t queue[W * H];
    int32_t visited;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* one draw per cell: a wall where the byte is above 190, and on the border */
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++) {
            int32_t high = lcg_u8(&s) > 190;
            wall[y * W + x] = (uint8_t)(high || x == 0 || y == 0 || x == W - 1 || y == H - 1);
        }
    wall[START] = 0;

    CYC_READ(c0);
    visited = grid_bfs(wall, W * H, START, offset, dist, queue);
    CYC_READ(c1);

    h = fnv_i16(h, dist, W * H);
    h = fnv_val32(h, (uint32_t)visited);
    report("grid_bfs", c1 - c0, h);
    PARAMS(SEED, visited, "cell");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("start", START);
    PARAMS_END();
    return 0;
}
