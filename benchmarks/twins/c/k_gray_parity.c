/* Gray codes of half-words, their parities, and the places of their highest bits. */
#include "ref.h"

#define SEED 1405u
#define N 250

KERNEL int32_t gray_parity(const uint16_t src[], int32_t n, uint16_t gray[], uint8_t highest[])
{
    int32_t odd = 0;
    for (int32_t i = 0; i < n; i++) {
        uint32_t v = src[i];
        uint32_t g = v ^ (v >> 1);
        gray[i] = (uint16_t)g;
        uint32_t p = g ^ (g >> 8);
        p ^= p >> 4;
        p ^= p >> 2;
        p ^= p >> 1;
        odd += (int32_t)(p & 1);
        int32_t k = 0;
        while (v > 1) {
            v >>= 1;
            k++;
        }
        highest[i] = (uint8_t)k;
    }
    return odd;
}

int main(void)
{
    static uint16_t src[N], gray[N];
    static uint8_t highest[N];
    int32_t odd;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++)
        src[i] = (uint16_t)lcg_u16(&s);

    CYC_READ(c0);
    odd = gray_parity(src, N, gray, highest);
    CYC_READ(c1);

    h = fnv_u16(h, gray, N);
    h = fnv_u8(h, highest, N);
    h = fnv_val32(h, (uint32_t)odd);
    report("gray_parity", c1 - c0, h);
    PARAMS(SEED, N, "word");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
