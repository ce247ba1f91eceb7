/* The cipher XTEA, 32 rounds. */
#include "ref.h"

#define SEED 2825u
#define BLOCKS 6

KERNEL void xtea_encrypt(uint32_t *words, int32_t blocks, const uint32_t key[4])
{
    for (int32_t block = 0; block < blocks; block++) {
        uint32_t v0 = words[0], v1 = words[1], total = 0;
        for (int32_t round = 0; round < 32; round++) {
            v0 += (((v1 << 4) ^ (v1 >> 5)) + v1) ^ (total + key[total & 3]);
            total += 0x9E3779B9u;
            v1 += (((v0 << 4) ^ (v0 >> 5)) + v0) ^ (total + key[(total >> 11) & 3]);
        }
        words[0] = v0;
        words[1] = v1;
        words += 2;
    }
}

int main(void)
{
    static uint32_t key[4], words[2 * BLOCKS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < 4; i++)
        key[i] = lcg_next(&s);
    for (int32_t i = 0; i < 2 * BLOCKS; i++)
        words[i] = lcg_next(&s);

    CYC_READ(c0);
    xtea_encrypt(words, BLOCKS, key);
    CYC_READ(c1);

    report("xtea_encrypt", c1 - c0, fnv_u32(FNV_INIT, words, 2 * BLOCKS));
    PARAMS(SEED, BLOCKS, "block");
    PARAM("blocks", BLOCKS);
    PARAMS_END();
    return 0;
}
