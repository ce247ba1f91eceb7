/* A scanner as a state machine: counts words, numbers and signs of a text, and the
 * characters of the longest word. */
#include "ref.h"

#define SEED 1147u
#define N 1000

KERNEL void tokens(const uint8_t text[], int32_t n, int32_t out[])
{
    int32_t state = 0;
    int32_t words = 0;
    int32_t numbers = 0;
    int32_t signs = 0;
    int32_t length = 0;
    int32_t longest = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t c = text[i];
        if (c >= 97 && c <= 122) {
            if (state != 1) {
                state = 1;
                words++;
                length = 0;
            }
            length++;
            if (length > longest) {
                longest = length;
            }
        } else if (c >= 48 && c <= 57) {
            if (state == 0) {
                state = 2;
                numbers++;
            } else if (state == 1) {
                length++;
            }
        } else if (c == 32) {
            state = 0;
        } else {
            state = 0;
            signs++;
        }
    }
    out[0] = words;
    out[1] = numbers;
    out[2] = signs;
    out[3] = longest;
}

int main(void)
{
    static uint8_t text[N];
    static int32_t out[4];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    /* one draw per character: a..z, 0..9, blanks and four signs from a table of 48 */
    for (int32_t i = 0; i < N; i++) {
        int32_t k = lcg_below(&s, 48);
        text[i] = (uint8_t)(k < 26 ? 97 + k : k < 36 ? 22 + k : k < 44 ? 32 : k - 4);
    }

    CYC_READ(c0);
    tokens(text, N, out);
    CYC_READ(c1);

    report("tokens", c1 - c0, fnv_i32(FNV_INIT, out, 4));
    PARAMS(SEED, N, "character");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
