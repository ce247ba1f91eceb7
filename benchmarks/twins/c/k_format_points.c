/* Points as lines of text.  Returns its length. */
#include "ref.h"

#define SEED 2826u
#define N 40

HELPER int32_t put_number(uint8_t text[], int32_t at, int32_t value)
{
    if (value < 0) {
        text[at++] = '-';
        value = -value;
    }
    int32_t end = at + 1;
    for (int32_t rest = value; rest >= 10; rest /= 10)
        end++;
    for (int32_t p = end; p > at; value /= 10)
        text[--p] = '0' + value % 10;
    return end;
}

KERNEL int32_t format_points(const int16_t xs[], const int16_t ys[], int32_t n, uint8_t text[])
{
    int32_t at = 0;
    for (int32_t i = 0; i < n; i++) {
        at = put_number(text, at, xs[i]);
        text[at++] = ',';
        at = put_number(text, at, ys[i]);
        text[at++] = '\n';
    }
    return at;
}

int main(void)
{
    static int16_t xs[N], ys[N];
    static uint8_t text[12 * N];
    int32_t length;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        xs[i] = (int16_t)(lcg_below(&s, 720) - 360);
    for (int32_t i = 0; i < N; i++)
        ys[i] = (int16_t)(lcg_below(&s, 20000) - 10000);

    CYC_READ(c0);
    length = format_points(xs, ys, N, text);
    CYC_READ(c1);

    h = fnv_u8(h, text, 12 * N);
    h = fnv_val32(h, (uint32_t)length);
    report("format_points", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
