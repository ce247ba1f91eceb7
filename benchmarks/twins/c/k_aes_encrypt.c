/* Encrypt blocks of 16 bytes in place, each by itself (AES-128). */
#include "ref.h"
#include <string.h>

#define SEED 3044u
#define BLOCKS 6
#define ROUNDS 10

static inline uint8_t twice(uint8_t b)
{
    return b << 1 ^ (b & 0x80 ? 0x1B : 0);
}

static void expand_key(const uint8_t key[16], const uint8_t sbox[256], uint8_t keys[16 * (ROUNDS + 1)])
{
    uint8_t constant = 1;

    memcpy(keys, key, 16);
    for (int32_t i = 16; i < 16 * (ROUNDS + 1); i += 4) {
        uint8_t *to = keys + i, word[4];
        memcpy(word, to - 4, 4);
        if (i % 16 == 0) {
            uint8_t first = word[0];
            word[0] = sbox[word[1]] ^ constant;
            word[1] = sbox[word[2]];
            word[2] = sbox[word[3]];
            word[3] = sbox[first];
            constant = twice(constant);
        }
        for (int32_t j = 0; j < 4; j++)
            to[j] = to[j - 16] ^ word[j];
    }
}

static void mix_column(uint8_t *column)
{
    uint8_t a = column[0], b = column[1], c = column[2], d = column[3];
    uint8_t every = a ^ b ^ c ^ d;

    column[0] = a ^ every ^ twice(a ^ b);
    column[1] = b ^ every ^ twice(b ^ c);
    column[2] = c ^ every ^ twice(c ^ d);
    column[3] = d ^ every ^ twice(d ^ a);
}

KERNEL void aes_encrypt(uint8_t *data, int32_t blocks, const uint8_t key[16], const uint8_t sbox[256])
{
    uint8_t keys[16 * (ROUNDS + 1)], state[16];

    expand_key(key, sbox, keys);
    for (; blocks > 0; blocks--, data += 16) {
        const uint8_t *round_key = keys;
        for (int32_t i = 0; i < 16; i++)
            data[i] ^= *round_key++;
        for (int32_t turn = 1; turn <= ROUNDS; turn++) {
            for (int32_t column = 0; column < 4; column++)
                for (int32_t row = 0; row < 4; row++)
                    state[4 * column + row] = sbox[data[(4 * (column + row) + row) % 16]];
            if (turn < ROUNDS)
                for (int32_t column = 0; column < 4; column++)
                    mix_column(state + 4 * column);
            for (int32_t i = 0; i < 16; i++)
                data[i] = state[i] ^ *round_key++;
        }
    }
}

/* The substitution: inverses in the field of AES, and an affine map of their bits. */
static void fill_sbox(uint8_t sbox[256])
{
    uint8_t p = 1, q = 1;

    sbox[0] = 0x63;
    for (int32_t i = 0; i < 255; i++) {
        p ^= twice(p);
        q ^= q << 1;
        q ^= q << 2;
        q ^= q << 4;
        if (q & 0x80)
            q ^= 0x09;
        uint32_t double_q = q | q << 8;
        sbox[p] = q ^ double_q >> 7 ^ double_q >> 6 ^ double_q >> 5 ^ double_q >> 4 ^ 0x63;
    }
}

int main(void)
{
    static uint8_t data[16 * BLOCKS], key[16], sbox[256];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    fill_sbox(sbox);
    for (int32_t i = 0; i < 16 * BLOCKS; i++)
        data[i] = lcg_u8(&s);
    for (int32_t i = 0; i < 16; i++)
        key[i] = lcg_u8(&s);

    CYC_READ(c0);
    aes_encrypt(data, BLOCKS, key, sbox);
    CYC_READ(c1);

    h = fnv_u8(h, data, 16 * BLOCKS);
    report("aes_encrypt", c1 - c0, h);
    PARAMS(SEED, BLOCKS, "block");
    PARAMS_END();
    return 0;
}
