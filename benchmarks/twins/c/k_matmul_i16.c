/* Product of two n x n matrices of 16-bit values, 32-bit sums. */
#include "ref.h"

#define SEED 1121u
#define N 16

KERNEL void matmul_i16(const int16_t a[], const int16_t b[], int32_t c[], int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        for (int32_t j = 0; j < n; j++) {
            int32_t sum = 0;
            for (int32_t k = 0; k < n; k++) {
                sum += a[i * n + k] * b[k * n + j];
            }
            c[i * n + j] = sum;
        }
    }
}

int main(void)
{
    static int16_t a[N * N], b[N * N];
    static int32_t c[N * N];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N * N; i++)
        a[i] = (int16_t)(lcg_below(&s, 4000) - 2000);
    for (int32_t i = 0; i < N * N; i++)
        b[i] = (int16_t)(lcg_below(&s, 4000) - 2000);

    CYC_READ(c0);
    matmul_i16(a, b, c, N);
    CYC_READ(c1);

    report("matmul_i16", c1 - c0, fnv_i32(FNV_INIT, c, N * N));
    PARAMS(SEED, N*N*N, "product");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
