/* Points (x, y, z) through a 3 x 4 matrix in 1/4096ths, then cut to a box. Returns how many lie inside. */
#include "ref.h"

#define SEED 1307u
#define N 120

KERNEL int32_t mat4_points(const int16_t points[], int32_t n, const int16_t matrix[], int16_t out[], int32_t half)
{
    int32_t inside = 0;
    for (int32_t i = 0; i < n; i++) {
        int32_t ok = 1;
        for (int32_t r = 0; r < 3; r++) {
            int32_t sum = matrix[4 * r + 3] << 12;
            for (int32_t c = 0; c < 3; c++) {
                sum += matrix[4 * r + c] * points[3 * i + c];
            }
            sum = sum >> 12;
            if (sum > half || sum < -half) {
                ok = 0;
            }
            out[3 * i + r] = (int16_t)sum;
        }
        inside += ok;
    }
    return inside;
}

int main(void)
{
    static int16_t points[3 * N], matrix[12], out[3 * N];
    int32_t inside;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 3 * N; i++)
        points[i] = (int16_t)(lcg_below(&s, 4000) - 2000);
    for (int32_t i = 0; i < 12; i++)
        matrix[i] = (int16_t)(lcg_below(&s, 8192) - 4096);

    CYC_READ(c0);
    inside = mat4_points(points, N, matrix, out, 1500);
    CYC_READ(c1);

    h = fnv_i16(h, out, 3 * N);
    h = fnv_val32(h, (uint32_t)inside);
    report("mat4_points", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
