/* CRC of 8 bits over messages of bytes, by a table of 16 entries. */
#include "ref.h"

#define SEED 1222u
#define N 600

KERNEL uint32_t crc8_nibbles(const uint8_t data[], int32_t n, const uint8_t table[])
{
    uint32_t crc = 0xff;
    for (int32_t i = 0; i < n; i++) {
        crc = crc ^ data[i];
        crc = ((crc << 4) & 0xff) ^ table[crc >> 4];
        crc = ((crc << 4) & 0xff) ^ table[crc >> 4];
    }
    return crc;
}

int main(void)
{
    static uint8_t data[N], table[16];
    uint32_t s = SEED, c0, c1, crc;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        data[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 16; i++)
        table[i] = (uint8_t)(i * 7 ^ i >> 1);

    CYC_READ(c0);
    crc = crc8_nibbles(data, N, table);
    CYC_READ(c1);

    report("crc8_nibbles", c1 - c0, fnv_val32(FNV_INIT, crc));
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
