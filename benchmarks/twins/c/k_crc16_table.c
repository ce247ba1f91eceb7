/* CRC-16 (CCITT) by a table of 256. */
#include "ref.h"

#define SEED 1410u
#define N 700

KERNEL uint32_t crc16_table(const uint8_t data[], int32_t n, const uint16_t table[])
{
    uint32_t crc = 0xFFFFu;
    for (int32_t i = 0; i < n; i++) {
        crc = ((crc << 8) & 0xFFFFu) ^ table[((crc >> 8) ^ data[i]) & 255];
    }
    return crc;
}

int main(void)
{
    static uint8_t data[N];
    static uint16_t table[256];
    uint32_t crc, s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        data[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < 256; i++)
        table[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    crc = crc16_table(data, N, table);
    CYC_READ(c1);

    h = fnv_val32(h, crc);
    report("crc16_table", c1 - c0, h);
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
