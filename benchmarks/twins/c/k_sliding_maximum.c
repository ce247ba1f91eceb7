/* Maxima of windows, by a queue of falling values. */
#include "ref.h"

#define SEED 2816u
#define N 300
#define WINDOW 15

KERNEL void sliding_maximum(const int16_t x[], int32_t n, int32_t window, int16_t queue[], int16_t out[])
{
    int32_t head = 0, tail = 0;
    for (int32_t i = 0; i < n; i++) {
        while (tail > head && x[queue[tail - 1]] <= x[i])
            tail--;
        queue[tail++] = i;
        if (queue[head] <= i - window)
            head++;
        if (i >= window - 1)
            out[i - window + 1] = x[queue[head]];
    }
}

int main(void)
{
    static int16_t x[N], queue[N], out[N - WINDOW + 1];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        x[i] = (int16_t)(lcg_below(&s, 2000) - 1000);

    CYC_READ(c0);
    sliding_maximum(x, N, WINDOW, queue, out);
    CYC_READ(c1);

    report("sliding_maximum", c1 - c0, fnv_i16(FNV_INIT, out, N - WINDOW + 1));
    PARAMS(SEED, N, "sample");
    PARAM("window", WINDOW);
    PARAMS_END();
    return 0;
}
