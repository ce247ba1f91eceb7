/* A convolutional code of four states and two bits a step, decoded. */
#include "ref.h"

#define SEED 2824u
#define N 96

KERNEL int32_t viterbi_decode(const uint8_t received[], int32_t n, const uint8_t outputs[8], int32_t metrics[8],
                              uint8_t decisions[], uint8_t bits[])
{
    for (int32_t state = 0; state < 4; state++)
        metrics[state] = 1000;
    metrics[0] = 0;
    for (int32_t t = 0; t < n; t++) {
        int32_t decided = 0;
        for (int32_t state = 0; state < 4; state++) {
            int32_t before = (state << 1) & 3;
            int32_t bit = state >> 1;
            int32_t wrong0 = received[t] ^ outputs[2 * before + bit];
            int32_t wrong1 = received[t] ^ outputs[2 * (before + 1) + bit];
            int32_t metric = metrics[before] + (wrong0 & 1) + (wrong0 >> 1);
            int32_t other = metrics[before + 1] + (wrong1 & 1) + (wrong1 >> 1);
            if (other < metric) {
                metric = other;
                decided |= 1 << state;
            }
            metrics[4 + state] = metric;
        }
        for (int32_t state = 0; state < 4; state++)
            metrics[state] = metrics[4 + state];
        decisions[t] = decided;
    }
    int32_t best = 0;
    for (int32_t state = 1; state < 4; state++) {
        if (metrics[state] < metrics[best])
            best = state;
    }
    int32_t errors = metrics[best];
    for (int32_t t = n - 1; t >= 0; t--) {
        bits[t] = best >> 1;
        best = ((best << 1) & 3) | ((decisions[t] >> best) & 1);
    }
    return errors;
}

int main(void)
{
    static uint8_t received[N], outputs[8], decisions[N], bits[N];
    static int32_t metrics[8];
    int32_t errors, state = 0;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 8; i++) {
        int32_t b = i & 1, b1 = i >> 2, b0 = (i >> 1) & 1;
        outputs[i] = (uint8_t)(((b ^ b1 ^ b0) << 1) | (b ^ b0));
    }
    for (int32_t t = 0; t < N; t++) {
        int32_t bit = lcg_below(&s, 2);
        received[t] = outputs[2 * state + bit];
        state = (bit << 1) | (state >> 1);
        if (lcg_below(&s, 10) == 0)
            received[t] ^= (uint8_t)(1 + lcg_below(&s, 3));
    }

    CYC_READ(c0);
    errors = viterbi_decode(received, N, outputs, metrics, decisions, bits);
    CYC_READ(c1);

    h = fnv_u8(h, bits, N);
    h = fnv_val32(h, (uint32_t)errors);
    report("viterbi_decode", c1 - c0, h);
    PARAMS(SEED, N, "step");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
