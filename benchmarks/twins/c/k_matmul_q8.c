/* Product of two square matrices in 1/256ths, 32-bit. */
#include "ref.h"

#define SEED 1407u
#define N 9

KERNEL void matmul_q8(const int32_t a[], const int32_t b[], int32_t c[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        for (int32_t j = 0; j < n; j++) {
            int32_t sum = 0;
            for (int32_t k = 0; k < n; k++) {
                sum += (a[i * n + k] * b[k * n + j]) >> 8;
            }
            c[i * n + j] = sum;
        }
    }
}

int main(void)
{
    static int32_t a[N * N], b[N * N], c[N * N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N * N; i++)
        a[i] = lcg_below(&s, 2048) - 1024;
    for (int32_t i = 0; i < N * N; i++)
        b[i] = lcg_below(&s, 2048) - 1024;

    CYC_READ(c0);
    matmul_q8(a, b, c, N);
    CYC_READ(c1);

    h = fnv_i32(h, c, N * N);
    report("matmul_q8", c1 - c0, h);
    PARAMS(SEED, N * N, "element");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
