/* Set bits of each word, one turn per set bit. */
#include "ref.h"

#define SEED 1109u
#define N 1000

KERNEL void popcount_words(const uint32_t words[], uint8_t count[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        uint32_t w = words[i];
        int32_t c = 0;
        while (w != 0) {
            w = w & (w - 1);
            c++;
        }
        count[i] = (uint8_t)c;
    }
}

int main(void)
{
    static uint32_t words[N];
    static uint8_t count[N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        words[i] = lcg_next(&s);

    CYC_READ(c0);
    popcount_words(words, count, N);
    CYC_READ(c1);

    report("popcount_words", c1 - c0, fnv_u8(FNV_INIT, count, N));
    PARAMS(SEED, N, "word");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
