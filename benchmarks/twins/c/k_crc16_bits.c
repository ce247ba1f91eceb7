/* CRC-16 (CCITT) of a buffer, bit by bit. */
#include "ref.h"

#define SEED 1111u
#define N 200

KERNEL int32_t crc16_bits(const uint8_t data[], int32_t n)
{
    int32_t crc = 0xFFFF;
    for (int32_t i = 0; i < n; i++) {
        crc = crc ^ (data[i] << 8);
        for (int32_t b = 0; b < 8; b++) {
            if ((crc & 0x8000) != 0) {
                crc = ((crc << 1) ^ 0x1021) & 0xFFFF;
            } else {
                crc = (crc << 1) & 0xFFFF;
            }
        }
    }
    return crc;
}

int main(void)
{
    static uint8_t data[N];
    int32_t crc;
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        data[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    crc = crc16_bits(data, N);
    CYC_READ(c1);

    report("crc16_bits", c1 - c0, fnv_val32(FNV_INIT, (uint32_t)crc));
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
