/* For each descriptor of one picture the nearest of another, unless the second is nearly as near. */
#include "ref.h"

#define SEED 2803u
#define N 20
#define LENGTH 16

KERNEL int32_t match_features(const uint8_t *a, int32_t n_a, const uint8_t *b, int32_t n_b, int32_t length, int16_t matches[])
{
    int32_t found = 0;
    for (int32_t i = 0; i < n_a; i++) {
        const uint8_t *p = a + i * length;
        int32_t best = 0x0FFFFFFF, second = 0x0FFFFFFF, which = -1;
        for (int32_t j = 0; j < n_b; j++) {
            const uint8_t *q = b + j * length;
            int32_t total = 0;
            for (int32_t k = 0; k < length; k++) {
                int32_t d = p[k] - q[k];
                total += d * d;
                if (total >= second)
                    break;
            }
            if (total < best) {
                second = best;
                best = total;
                which = j;
            } else if (total < second) {
                second = total;
            }
        }
        if (4 * best < 3 * second) {
            matches[i] = which;
            found++;
        } else {
            matches[i] = -1;
        }
    }
    return found;
}

int main(void)
{
    static uint8_t a[N * LENGTH], b[N * LENGTH];
    static int16_t matches[N];
    int32_t found;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N * LENGTH; i++)
        a[i] = (uint8_t)lcg_below(&s, 240);
    for (int32_t i = 0; i < N; i++)
        for (int32_t k = 0; k < LENGTH; k++)
            b[i * LENGTH + k] = (uint8_t)(a[(N - 1 - i) * LENGTH + k] + lcg_below(&s, 12));

    CYC_READ(c0);
    found = match_features(a, N, b, N, LENGTH, matches);
    CYC_READ(c1);

    h = fnv_i16(h, matches, N);
    h = fnv_val32(h, (uint32_t)found);
    report("match_features", c1 - c0, h);
    PARAMS(SEED, N, "feature");
    PARAM("length", LENGTH);
    PARAMS_END();
    return 0;
}
