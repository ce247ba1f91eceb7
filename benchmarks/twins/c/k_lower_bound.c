/* First place of each key in a sorted table, by halving. */
#include "ref.h"

#define SEED 1210u
#define N 150
#define KEYS 200

KERNEL void lower_bound(const uint16_t table[], int32_t n, const uint16_t keys[], uint16_t place[], int32_t m)
{
    for (int32_t i = 0; i < m; i++) {
        uint32_t key = keys[i];
        int32_t lo = 0;
        int32_t hi = n;
        while (lo < hi) {
            int32_t mid = (lo + hi) >> 1;
            if (table[mid] < key) {
                lo = mid + 1;
            } else {
                hi = mid;
            }
        }
        place[i] = (uint16_t)lo;
    }
}

int main(void)
{
    static uint16_t table[N], keys[KEYS], place[KEYS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        table[i] = (uint16_t)(400 * i + lcg_below(&s, 400));
    for (int32_t i = 0; i < KEYS; i++)
        keys[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    lower_bound(table, N, keys, place, KEYS);
    CYC_READ(c1);

    report("lower_bound", c1 - c0, fnv_u16(FNV_INIT, place, KEYS));
    PARAMS(SEED, KEYS, "key");
    PARAM("n", N);
    PARAM("keys", KEYS);
    PARAMS_END();
    return 0;
}
