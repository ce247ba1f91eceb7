/* Steps from 1..n to 1 by halving and 3 v + 1; returns the start with the most steps. */
#include "ref.h"

#define SEED 1144u
#define N 60

KERNEL int32_t collatz(uint8_t steps[], int32_t n)
{
    int32_t best = 0;
    int32_t most = -1;
    for (int32_t i = 0; i < n; i++) {
        uint32_t v = (uint32_t)(i + 1);
        int32_t k = 0;
        while (v != 1) {
            if ((v & 1) != 0) {
                v = 3 * v + 1;
            } else {
                v = v >> 1;
            }
            k++;
        }
        steps[i] = (uint8_t)k;
        if (k > most) {
            most = k;
            best = i + 1;
        }
    }
    return best;
}

int main(void)
{
    static uint8_t steps[N];
    int32_t best;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    (void)s;

    CYC_READ(c0);
    best = collatz(steps, N);
    CYC_READ(c1);

    h = fnv_u8(h, steps, N);
    h = fnv_val32(h, (uint32_t)best);
    report("collatz", c1 - c0, h);
    PARAMS(SEED, N, "start");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
