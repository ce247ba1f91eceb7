/* Connected parts of a graph: union-find with path halving.  Returns the number of parts. */
#include "ref.h"

#define SEED 1136u
#define N 250
#define NODES 300

HELPER int32_t find_root(uint16_t parent[], int32_t x)
{
    while (parent[x] != x) {
        parent[x] = parent[parent[x]];
        x = parent[x];
    }
    return x;
}

KERNEL int32_t union_find(const uint16_t a[], const uint16_t b[], int32_t n, uint16_t parent[],
                          int32_t nodes)
{
    int32_t parts = nodes;
    for (int32_t i = 0; i < nodes; i++) {
        parent[i] = (uint16_t)i;
    }
    for (int32_t i = 0; i < n; i++) {
        int32_t x = find_root(parent, a[i]);
        int32_t y = find_root(parent, b[i]);
        if (x < y) {
            parent[y] = (uint16_t)x;
            parts--;
        } else if (y < x) {
            parent[x] = (uint16_t)y;
            parts--;
        }
    }
    return parts;
}

int main(void)
{
    static uint16_t a[N], b[N], parent[NODES];
    int32_t parts;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint16_t)lcg_below(&s, NODES);
    for (int32_t i = 0; i < N; i++)
        b[i] = (uint16_t)lcg_below(&s, NODES);

    CYC_READ(c0);
    parts = union_find(a, b, N, parent, NODES);
    CYC_READ(c1);

    h = fnv_u16(h, parent, NODES);
    h = fnv_val32(h, (uint32_t)parts);
    report("union_find", c1 - c0, h);
    PARAMS(SEED, N, "edge");
    PARAM("n", N);
    PARAM("nodes", NODES);
    PARAMS_END();
    return 0;
}
