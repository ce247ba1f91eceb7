/* Of each descriptor, the one that differs in the fewest bits; bits are counted in parallel. */
#include "ref.h"

#define SEED 1304u
#define N 24
#define M 30

KERNEL void hamming_pairs(const uint32_t a[], int32_t n, const uint32_t b[], int32_t m, uint8_t nearest[],
                          uint8_t distance[])
{
    for (int32_t i = 0; i < n; i++) {
        int32_t best = 33;
        int32_t at = 0;
        for (int32_t j = 0; j < m; j++) {
            uint32_t x = a[i] ^ b[j];
            x = x - ((x >> 1) & 0x55555555u);
            x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
            x = (x + (x >> 4)) & 0x0F0F0F0Fu;
            x = x + (x >> 8);
            x = x + (x >> 16);
            int32_t d = (int32_t)(x & 63);
            if (d < best) {
                best = d;
                at = j;
            }
        }
        nearest[i] = (uint8_t)at;
        distance[i] = (uint8_t)best;
    }
}

int main(void)
{
    static uint32_t a[N], b[M];
    static uint8_t nearest[N], distance[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = lcg_next(&s);
    for (int32_t i = 0; i < M; i++)
        b[i] = lcg_next(&s);

    CYC_READ(c0);
    hamming_pairs(a, N, b, M, nearest, distance);
    CYC_READ(c1);

    h = fnv_u8(h, nearest, N);
    h = fnv_u8(h, distance, N);
    report("hamming_pairs", c1 - c0, h);
    PARAMS(SEED, N * M, "pair");
    PARAM("n", N);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
