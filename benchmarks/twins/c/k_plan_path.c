/* Cells of a shortest path (A*), from the goal back; 32 a row, walls surround them. -1 if there is no path. */
#include "ref.h"
#include <stdlib.h>

#define SEED 2933u
#define W 32
#define H 20
#define CELLS (W * H)
#define UNKNOWN 0xFFFF

HELPER void open_push(int32_t heap[], int32_t size, int32_t entry)
{
    int32_t at = size;
    while (at > 0) {
        int32_t parent = (at - 1) / 2;
        if (heap[parent] <= entry)
            break;
        heap[at] = heap[parent];
        at = parent;
    }
    heap[at] = entry;
}

HELPER int32_t open_pop(int32_t heap[], int32_t size)
{
    int32_t first = heap[0], last = heap[--size];
    int32_t at = 0, child = 1;
    while (child < size) {
        if (child + 1 < size && heap[child + 1] < heap[child])
            child++;
        if (heap[child] >= last)
            break;
        heap[at] = heap[child];
        at = child;
        child = 2 * at + 1;
    }
    heap[at] = last;
    return first;
}

KERNEL int32_t plan_path(const uint8_t *grid, int32_t cells, int32_t start, int32_t goal, uint16_t *costs, uint8_t *came,
                         const int16_t steps[4], int32_t *heap, uint16_t *path)
{
    for (int32_t i = 0; i < cells; i++)
        costs[i] = UNKNOWN;
    int32_t goal_x = goal & 31, goal_y = goal >> 5;
    costs[start] = 0;
    heap[0] = start;
    int32_t size = 1;
    while (size > 0) {
        int32_t cell = open_pop(heap, size--) & 0xFFFF;
        if (cell == goal)
            break;
        int32_t cost = costs[cell] + 1;
        for (int32_t d = 0; d < 4; d++) {
            int32_t to = cell + steps[d];
            if (grid[to] || cost >= costs[to])
                continue;
            costs[to] = cost;
            came[to] = d;
            int32_t guess = abs((to & 31) - goal_x) + abs((to >> 5) - goal_y);
            open_push(heap, size++, ((cost + guess) << 16) | to);
        }
    }
    if (costs[goal] == UNKNOWN)
        return -1;
    int32_t length = 0;
    for (int32_t cell = goal; cell != start; cell -= steps[came[cell]])
        path[length++] = cell;
    return length;
}

int main(void)
{
    static const int16_t steps[4] = {1, W, -1, -W};
    static uint8_t grid[CELLS], came[CELLS];
    static uint16_t costs[CELLS], path[CELLS];
    static int32_t heap[2 * CELLS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < CELLS; i++) {
        int32_t x = i % W, y = i / W;
        if (x == 0 || y == 0 || x == W - 1 || y == H - 1)
            grid[i] = 1;
        else
            grid[i] = lcg_below(&s, 4) == 0;
    }
    grid[2 * W + 2] = grid[17 * W + 28] = 0;

    CYC_READ(c0);
    int32_t length = plan_path(grid, CELLS, 2 * W + 2, 17 * W + 28, costs, came, steps, heap, path);
    CYC_READ(c1);

    h = fnv_u16(h, costs, CELLS);
    h = fnv_u16(h, path, CELLS);
    h = fnv_i32(h, &length, 1);
    report("plan_path", c1 - c0, h);
    PARAMS(SEED, CELLS, "cell");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
