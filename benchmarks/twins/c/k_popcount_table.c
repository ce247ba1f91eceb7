/* Bits of 32-bit words, counted byte by byte in a table. */
#include "ref.h"

#define SEED 1303u
#define N 300

KERNEL int32_t popcount_table(const uint32_t words[], int32_t n, const uint8_t table[], uint8_t counts[])
{
    int32_t total = 0;
    for (int32_t i = 0; i < n; i++) {
        uint32_t w = words[i];
        int32_t c = table[w & 255] + table[(w >> 8) & 255] + table[(w >> 16) & 255] + table[w >> 24];
        counts[i] = (uint8_t)c;
        total += c;
    }
    return total;
}

int main(void)
{
    static uint32_t words[N];
    static uint8_t table[256], counts[N];
    int32_t total;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        words[i] = lcg_next(&s);
    for (int32_t i = 1; i < 256; i++)
        table[i] = (uint8_t)(table[i >> 1] + (i & 1));

    CYC_READ(c0);
    total = popcount_table(words, N, table, counts);
    CYC_READ(c1);

    h = fnv_u8(h, counts, N);
    h = fnv_val32(h, (uint32_t)total);
    report("popcount_table", c1 - c0, h);
    PARAMS(SEED, N, "word");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
