/* Where each of a list of words of m characters first is in a text, -1 if nowhere. */
#include "ref.h"

#define SEED 1148u
#define N 160
#define WORDS 12
#define M 4

KERNEL void find_words(const uint8_t text[], int32_t n, const uint8_t list[], int32_t words, int32_t m,
                       int16_t place[])
{
    for (int32_t j = 0; j < words; j++) {
        int32_t found = -1;
        for (int32_t i = 0; i <= n - m; i++) {
            int32_t k = 0;
            while (k < m && text[i + k] == list[j * m + k]) {
                k++;
            }
            if (k == m) {
                found = i;
                break;
            }
        }
        place[j] = (int16_t)found;
    }
}

int main(void)
{
    static uint8_t text[N], list[WORDS * M];
    static int16_t place[WORDS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* three letters */
    for (int32_t i = 0; i < N; i++)
        text[i] = (uint8_t)(97 + lcg_below(&s, 3));
    for (int32_t i = 0; i < WORDS * M; i++)
        list[i] = (uint8_t)(97 + lcg_below(&s, 3));

    CYC_READ(c0);
    find_words(text, N, list, WORDS, M, place);
    CYC_READ(c1);

    report("find_words", c1 - c0, fnv_i16(FNV_INIT, place, WORDS));
    PARAMS(SEED, WORDS, "word");
    PARAM("n", N);
    PARAM("words", WORDS);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
