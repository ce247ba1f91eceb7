/* Places where a short pattern of bytes stands in a text. Returns how many there are. */
#include "ref.h"

#define SEED 1230u
#define N 800
#define M 3

KERNEL int32_t find_pattern(const uint8_t text[], int32_t n, const uint8_t pattern[], int32_t m, uint16_t place[])
{
    int32_t found = 0;
    for (int32_t i = 0; i <= n - m; i++) {
        int32_t j = 0;
        while (j < m && text[i + j] == pattern[j]) {
            j++;
        }
        if (j == m) {
            place[found] = (uint16_t)i;
            found++;
        }
    }
    return found;
}

int main(void)
{
    static uint8_t text[N], pattern[M];
    static uint16_t place[N];
    int32_t found;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        text[i] = (uint8_t)(97 + lcg_below(&s, 3));
    for (int32_t i = 0; i < M; i++)
        pattern[i] = (uint8_t)(97 + lcg_below(&s, 3));

    CYC_READ(c0);
    found = find_pattern(text, N, pattern, M, place);
    CYC_READ(c1);

    h = fnv_u16(h, place, N);
    h = fnv_val32(h, (uint32_t)found);
    report("find_pattern", c1 - c0, h);
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAM("m", M);
    PARAMS_END();
    return 0;
}
