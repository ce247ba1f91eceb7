/* Contrast of a picture stretched between two percentiles of its histogram, through a table. */
#include "ref.h"

#define SEED 1227u
#define N 1500

KERNEL void stretch(uint8_t image[], int32_t n, uint16_t histogram[], uint8_t table[], int32_t cut)
{
    for (int32_t i = 0; i < 256; i++) {
        histogram[i] = 0;
    }
    for (int32_t i = 0; i < n; i++) {
        histogram[image[i]]++;
    }
    int32_t low = 0;
    int32_t sum = histogram[0];
    while (sum < cut) {
        low++;
        sum += histogram[low];
    }
    int32_t high = 255;
    sum = histogram[255];
    while (sum < cut) {
        high--;
        sum += histogram[high];
    }
    int32_t range = high - low;
    int32_t scale = (255 << 8) / (range > 0 ? range : 1);
    for (int32_t i = 0; i < 256; i++) {
        int32_t v = ((i - low) * scale) >> 8;
        if (v < 0) {
            v = 0;
        }
        if (v > 255) {
            v = 255;
        }
        table[i] = (uint8_t)v;
    }
    for (int32_t i = 0; i < n; i++) {
        image[i] = table[image[i]];
    }
}

int main(void)
{
    static uint8_t image[N], table[256];
    static uint16_t histogram[256];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        image[i] = (uint8_t)(60 + lcg_below(&s, 50) + lcg_below(&s, 60));

    CYC_READ(c0);
    stretch(image, N, histogram, table, 40);
    CYC_READ(c1);

    report("stretch", c1 - c0, fnv_u8(FNV_INIT, image, N));
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
