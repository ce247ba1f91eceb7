/* Transpose of 32 x 32 bits, and the set bits of each row. */
#include "ref.h"

#define SEED 1505u
#define N 32

KERNEL void bit_matrix(const uint32_t rows[], uint32_t columns[], uint8_t bits[])
{
    for (int32_t i = 0; i < 32; i++) {
        uint32_t word = 0;
        int32_t count = 0;
        for (int32_t j = 0; j < 32; j++) {
            uint32_t bit = (rows[j] >> i) & 1;
            word |= bit << j;
            if (((rows[i] >> j) & 1) != 0) {
                count++;
            }
        }
        columns[i] = word;
        bits[i] = (uint8_t)count;
    }
}

int main(void)
{
    static uint32_t rows[N], columns[N];
    static uint8_t bits[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        rows[i] = lcg_next(&s);

    CYC_READ(c0);
    bit_matrix(rows, columns, bits);
    CYC_READ(c1);

    h = fnv_u32(h, columns, N);
    h = fnv_u8(h, bits, N);
    report("bit_matrix", c1 - c0, h);
    PARAMS(SEED, N, "row");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
