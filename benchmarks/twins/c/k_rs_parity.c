/* Sixteen bytes of parity (Reed and Solomon); the generator is given by its logarithms. */
#include "ref.h"
#include <string.h>

#define SEED 2942u
#define N 120
#define PARITY 16

KERNEL void rs_parity(const uint8_t *message, int32_t n, const uint8_t *generator, const uint8_t *logs, const uint8_t *powers,
                      uint8_t *parity)
{
    memset(parity, 0, PARITY);
    for (int32_t i = 0; i < n; i++) {
        uint8_t feedback = message[i] ^ parity[0];
        if (feedback == 0) {
            memmove(parity, parity + 1, PARITY - 1);
            parity[PARITY - 1] = 0;
        } else {
            const uint8_t *power = powers + logs[feedback];
            for (int32_t j = 0; j < PARITY - 1; j++)
                parity[j] = parity[j + 1] ^ power[generator[j]];
            parity[PARITY - 1] = power[generator[PARITY - 1]];
        }
    }
}

int main(void)
{
    static uint8_t message[N], generator[PARITY], logs[256], powers[510], parity[PARITY];
    int32_t x = 1;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 255; i++) {
        powers[i] = powers[i + 255] = x;
        logs[x] = i;
        x = x << 1 ^ (x & 0x80 ? 0x11D : 0);
    }
    for (int32_t i = 0; i < PARITY; i++)
        generator[i] = lcg_below(&s, 255);
    for (int32_t i = 0; i < N; i++)
        message[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    rs_parity(message, N, generator, logs, powers, parity);
    CYC_READ(c1);

    h = fnv_u8(h, parity, PARITY);
    report("rs_parity", c1 - c0, h);
    PARAMS(SEED, N, "byte");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
