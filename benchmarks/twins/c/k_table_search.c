/* Binary search: for every key the number of table entries that are not above it. */
#include "ref.h"

#define SEED 1104u
#define N 200
#define M 64

KERNEL void table_search(const uint16_t keys[], int32_t n, const uint16_t table[], int32_t m,
                         uint8_t place[])
{
    for (int32_t i = 0; i < n; i++) {
        int32_t key = keys[i];
        int32_t lo = 0;
        int32_t hi = m;
        while (lo < hi) {
            int32_t mid = (lo + hi) >> 1;
            if (table[mid] <= key) {
                lo = mid + 1;
            } else {
                hi = mid;
            }
        }
        place[i] = (uint8_t)lo;
    }
}

int main(void)
{
    static uint16_t keys[N], table[M];
    static uint8_t place[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        keys[i] = (uint16_t)lcg_u16(&s);
    for (int32_t i = 0; i < M; i++)
        table[i] = (uint16_t)(i * 1000 + lcg_below(&s, 1000));

    CYC_READ(c0);
    table_search(keys, N, table, M, place);
    CYC_READ(c1);

    report("table_search", c1 - c0, fnv_u8(FNV_INIT, place, N));
    PARAMS(SEED, N, "key");
    PARAM("n", N);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
