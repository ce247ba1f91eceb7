/* Median of 3 x 3 pixels of one row: sort the columns, then the median of the
 * largest low, the middle median and the smallest high. */
#include "ref.h"

#define SEED 1119u
#define W 160

#define MIN(a, b) ((a) < (b) ? (a) : (b))
#define MAX(a, b) ((a) > (b) ? (a) : (b))

KERNEL void median9_row(const uint8_t r0[], const uint8_t r1[], const uint8_t r2[], uint8_t out[],
                        int32_t w)
{
    for (int32_t x = 1; x < w - 1; x++) {
        int32_t a = r0[x - 1];
        int32_t b = r1[x - 1];
        int32_t c = r2[x - 1];
        int32_t p = MIN(a, b);
        int32_t q = MAX(a, b);
        int32_t low = MIN(p, c);
        int32_t high = MAX(q, c);
        int32_t m0 = MIN(q, c);
        m0 = MAX(p, m0);

        a = r0[x];
        b = r1[x];
        c = r2[x];
        p = MIN(a, b);
        q = MAX(a, b);
        int32_t l1 = MIN(p, c);
        int32_t h1 = MAX(q, c);
        int32_t m1 = MIN(q, c);
        m1 = MAX(p, m1);
        low = MAX(low, l1);
        high = MIN(high, h1);

        a = r0[x + 1];
        b = r1[x + 1];
        c = r2[x + 1];
        p = MIN(a, b);
        q = MAX(a, b);
        l1 = MIN(p, c);
        h1 = MAX(q, c);
        int32_t m2 = MIN(q, c);
        m2 = MAX(p, m2);
        low = MAX(low, l1);
        high = MIN(high, h1);

        p = MIN(m0, m1);
        q = MAX(m0, m1);
        int32_t mid = MIN(q, m2);
        mid = MAX(p, mid);

        p = MIN(low, mid);
        q = MAX(low, mid);
        mid = MIN(q, high);
        mid = MAX(p, mid);
        out[x] = (uint8_t)mid;
    }
}

int main(void)
{
    static uint8_t r0[W], r1[W], r2[W], out[W];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W; i++)
        r0[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < W; i++)
        r1[i] = (uint8_t)lcg_u8(&s);
    for (int32_t i = 0; i < W; i++)
        r2[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    median9_row(r0, r1, r2, out, W);
    CYC_READ(c1);

    report("median9_row", c1 - c0, fnv_u8(FNV_INIT, out, W));
    PARAMS(SEED, W, "pixel");
    PARAM("w", W);
    PARAMS_END();
    return 0;
}
