/* Readings of an encoder with 4096 steps a turn, as steps from the start. */
#include "ref.h"

#define SEED 2833u
#define N 256

KERNEL void unwrap_phase(const int16_t phases[], int32_t n, int32_t out[])
{
    int32_t turned = 0;
    int32_t before = phases[0];
    for (int32_t i = 0; i < n; i++) {
        int32_t step = phases[i] - before;
        if (step > 2048)
            turned -= 4096;
        else if (step < -2048)
            turned += 4096;
        out[i] = turned + phases[i];
        before = phases[i];
    }
}

int main(void)
{
    static int16_t phases[N];
    static int32_t out[N];
    int32_t at = 0;
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        at += lcg_below(&s, 1200) - 400;
        phases[i] = (int16_t)(at & 4095);
    }

    CYC_READ(c0);
    unwrap_phase(phases, N, out);
    CYC_READ(c1);

    report("unwrap_phase", c1 - c0, fnv_i32(FNV_INIT, out, N));
    PARAMS(SEED, N, "reading");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
