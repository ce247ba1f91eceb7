/* Union-find with sizes: joins n pairs of nodes. Returns the size of the largest part. */
#include "ref.h"

#define SEED 1209u
#define N 200
#define NODES 256

KERNEL int32_t union_by_size(const uint8_t a[], const uint8_t b[], int32_t n, int32_t parent[], int32_t size[],
                             int32_t nodes)
{
    int32_t largest = 1;
    for (int32_t i = 0; i < nodes; i++) {
        parent[i] = i;
        size[i] = 1;
    }
    for (int32_t i = 0; i < n; i++) {
        int32_t x = a[i];
        while (parent[x] != x) {
            x = parent[x];
        }
        int32_t y = b[i];
        while (parent[y] != y) {
            y = parent[y];
        }
        if (x == y) {
            continue;
        }
        if (size[x] < size[y]) {
            int32_t t = x;
            x = y;
            y = t;
        }
        parent[y] = x;
        size[x] += size[y];
        if (size[x] > largest) {
            largest = size[x];
        }
    }
    return largest;
}

int main(void)
{
    static uint8_t a[N], b[N];
    static int32_t parent[NODES], size[NODES];
    int32_t largest;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < N; i++)
        b[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    largest = union_by_size(a, b, N, parent, size, NODES);
    CYC_READ(c1);

    h = fnv_i32(h, parent, NODES);
    h = fnv_val32(h, (uint32_t)largest);
    report("union_by_size", c1 - c0, h);
    PARAMS(SEED, N, "pair");
    PARAM("n", N);
    PARAM("nodes", NODES);
    PARAMS_END();
    return 0;
}
