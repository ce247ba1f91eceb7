/* How often each of some words of a length stands in a text. */
#include "ref.h"

#define SEED 1243u
#define N 300
#define M 4
#define LENGTH 2

KERNEL void count_words(const uint8_t text[], int32_t n, const uint8_t words[], int32_t m, int32_t length,
                        int32_t count[])
{
    for (int32_t k = 0; k < m; k++) {
        int32_t hits = 0;
        for (int32_t i = 0; i + length <= n; i++) {
            int32_t same = 1;
            for (int32_t j = 0; j < length; j++) {
                if (text[i + j] != words[k * length + j]) {
                    same = 0;
                    break;
                }
            }
            hits += same;
        }
        count[k] = hits;
    }
}

int main(void)
{
    static uint8_t text[N], words[M * LENGTH];
    static int32_t count[M];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        text[i] = (uint8_t)(97 + lcg_below(&s, 4));
    for (int32_t i = 0; i < M * LENGTH; i++)
        words[i] = (uint8_t)(97 + lcg_below(&s, 4));

    CYC_READ(c0);
    count_words(text, N, words, M, LENGTH, count);
    CYC_READ(c1);

    report("count_words", c1 - c0, fnv_i32(FNV_INIT, count, M));
    PARAMS(SEED, N * M, "byte");
    PARAM("n", N);
    PARAM("m", M);
    PARAM("length", LENGTH);
    PARAMS_END();
    return 0;
}
