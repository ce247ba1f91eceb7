/* Two sorted rows merged into one, without what occurs twice. */
#include "ref.h"

#define SEED 2103u
#define N 200

KERNEL int32_t merge_once(const uint16_t a[], const uint16_t b[], uint16_t out[], int32_t n)
{
    int32_t i = 0;
    int32_t j = 0;
    int32_t k = 0;
    while (i < n && j < n) {
        int32_t p = a[i];
        int32_t q = b[j];
        if (p < q) {
            out[k] = (uint16_t)p;
            i++;
        } else {
            if (p == q)
                i++;
            out[k] = (uint16_t)q;
            j++;
        }
        k++;
    }
    return k;
}

int main(void)
{
    static uint16_t a[N], b[N], out[2 * N];
    int32_t k;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        a[i] = (uint16_t)(4 * i + lcg_below(&s, 4));
    for (int32_t i = 0; i < N; i++)
        b[i] = (uint16_t)(4 * i + lcg_below(&s, 4));

    CYC_READ(c0);
    k = merge_once(a, b, out, N);
    CYC_READ(c1);

    h = fnv_u16(h, out, 2 * N);
    h = fnv_val32(h, (uint32_t)k);
    report("merge_once", c1 - c0, h);
    PARAMS(SEED, N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
