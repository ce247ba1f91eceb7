/* CRC-32 (Ethernet) of a buffer by a table of 256 words. */
#include "ref.h"

#define SEED 1105u
#define N 1500

KERNEL uint32_t crc32_table(const uint8_t data[], int32_t n, const uint32_t table[])
{
    uint32_t crc = 0xFFFFFFFFu;
    for (int32_t i = 0; i < n; i++) {
        crc = table[(crc ^ data[i]) & 255u] ^ (crc >> 8);
    }
    return ~crc;
}

int main(void)
{
    static uint8_t data[N];
    static uint32_t table[256];
    uint32_t crc;
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        data[i] = (uint8_t)lcg_u8(&s);
    for (uint32_t i = 0; i < 256; i++) {
        table[i] = i;
        for (int32_t b = 0; b < 8; b++)
            table[i] = (table[i] & 1u) != 0 ? (table[i] >> 1) ^ 0xEDB88320u : table[i] >> 1;
    }

    CYC_READ(c0);
    crc = crc32_table(data, N, table);
    CYC_READ(c1);

    report("crc32_table", c1 - c0, fnv_val32(FNV_INIT, crc));
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
