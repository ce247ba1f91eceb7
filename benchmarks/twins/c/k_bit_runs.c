/* Run lengths of equal bits, from the top bit of the first word on; the first run
 * is of zeros and may be empty.  Returns the number of runs. */
#include "ref.h"

#define SEED 1113u
#define N 64
#define MAX_RUNS 1000

KERNEL int32_t bit_runs(const uint32_t words[], int32_t n, uint8_t runs[], int32_t max_runs)
{
    int32_t count = 0;
    int32_t run = 0;
    uint32_t last = 0;
    for (int32_t i = 0; i < n; i++) {
        uint32_t w = words[i];
        for (int32_t b = 0; b < 32; b++) {
            uint32_t bit = w >> 31;
            w = w << 1;
            if (bit == last) {
                run = run + 1;
            } else {
                if (count < max_runs) {
                    runs[count] = (uint8_t)run;
                    count = count + 1;
                }
                run = 1;
                last = bit;
            }
        }
    }
    return count;
}

int main(void)
{
    static uint32_t words[N];
    static uint8_t runs[MAX_RUNS];
    int32_t count;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* a & (a >> 3) of one draw: more zeros than ones */
    for (int32_t i = 0; i < N; i++) {
        uint32_t a = lcg_next(&s);
        words[i] = a & (a >> 3);
    }

    CYC_READ(c0);
    count = bit_runs(words, N, runs, MAX_RUNS);
    CYC_READ(c1);

    h = fnv_u8(h, runs, MAX_RUNS);
    h = fnv_val32(h, (uint32_t)count);
    report("bit_runs", c1 - c0, h);
    PARAMS(SEED, N*32, "bit");
    PARAM("n", N);
    PARAM("max_runs", MAX_RUNS);
    PARAMS_END();
    return 0;
}
