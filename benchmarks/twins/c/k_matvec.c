/* Matrix of 32-bit values times a vector, results in 24.8. */
#include "ref.h"

#define SEED 1120u
#define ROWS 30
#define COLS 24

KERNEL void matvec(const int32_t m[], const int32_t v[], int32_t out[], int32_t rows, int32_t cols)
{
    int32_t k = 0;
    for (int32_t r = 0; r < rows; r++) {
        int32_t sum = 0;
        for (int32_t c = 0; c < cols; c++) {
            sum += m[k] * v[c];
            k++;
        }
        out[r] = sum >> 8;
    }
}

int main(void)
{
    static int32_t m[ROWS * COLS], v[COLS], out[ROWS];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < ROWS * COLS; i++)
        m[i] = lcg_below(&s, 2000) - 1000;
    for (int32_t i = 0; i < COLS; i++)
        v[i] = lcg_below(&s, 60000) - 30000;

    CYC_READ(c0);
    matvec(m, v, out, ROWS, COLS);
    CYC_READ(c1);

    report("matvec", c1 - c0, fnv_i32(FNV_INIT, out, ROWS));
    PARAMS(SEED, ROWS*COLS, "product");
    PARAM("rows", ROWS);
    PARAM("cols", COLS);
    PARAMS_END();
    return 0;
}
