/* Codes of many lengths, packed into bytes. */
#include "ref.h"

#define SEED 2823u
#define N 300
#define SYMBOLS 16
#define MOST 400

KERNEL int32_t huffman_encode(const uint8_t *data, int32_t n, const uint16_t codes[], const uint8_t lengths[], uint8_t *out)
{
    uint8_t *start = out;
    uint32_t held = 0;
    int32_t bits = 0;
    for (int32_t i = 0; i < n; i++) {
        uint8_t symbol = data[i];
        held = (held << lengths[symbol]) | codes[symbol];
        bits += lengths[symbol];
        while (bits >= 8) {
            bits -= 8;
            *out++ = held >> bits;
        }
    }
    if (bits > 0)
        *out++ = held << (8 - bits);
    return out - start;
}

int main(void)
{
    static uint8_t data[N], lengths[SYMBOLS], out[MOST];
    static uint16_t codes[SYMBOLS];
    int32_t length;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < SYMBOLS; i++) {
        lengths[i] = (uint8_t)(2 + (i >> 1));
        codes[i] = (uint16_t)lcg_below(&s, 1u << lengths[i]);
    }
    for (int32_t i = 0; i < N; i++) {
        data[i] = (uint8_t)lcg_below(&s, 16);
        data[i] &= (uint8_t)lcg_below(&s, 16);
    }

    CYC_READ(c0);
    length = huffman_encode(data, N, codes, lengths, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, MOST);
    h = fnv_val32(h, (uint32_t)length);
    report("huffman_encode", c1 - c0, h);
    PARAMS(SEED, N, "symbol");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
