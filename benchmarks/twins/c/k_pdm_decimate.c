/* Samples from a microphone of one bit: three integrators, every 32nd, three combs, and no steady part. */
#include "ref.h"

#define SEED 3022u
#define N 400

struct cic {
    int32_t sums[3];
    int32_t before[3];
    int32_t steady;
};

KERNEL void pdm_decimate(const uint8_t *bits, int32_t n, struct cic *cic, int16_t *out)
{
    uint32_t a = cic->sums[0], b = cic->sums[1], c = cic->sums[2]; /* they wrap, and the combs undo it */

    for (int32_t i = 0; i < n; i++) {
        for (uint32_t mask = 0x80; mask; mask >>= 1) {
            a += bits[i] & mask ? 1 : -1;
            b += a;
            c += b;
        }
        if (i % 4 != 3)
            continue;

        uint32_t value = c;
        for (int32_t k = 0; k < 3; k++) {
            uint32_t before = cic->before[k];
            cic->before[k] = value;
            value -= before;
        }
        int32_t level = (int32_t)value * 4;
        cic->steady += (level - cic->steady) >> 6;
        level = (level - cic->steady) >> 3;
        if (level > INT16_MAX)
            level = INT16_MAX;
        if (level < INT16_MIN)
            level = INT16_MIN;
        *out++ = level;
    }
    cic->sums[0] = a;
    cic->sums[1] = b;
    cic->sums[2] = c;
}

int main(void)
{
    static uint8_t bits[N];
    static int16_t out[N / 4];
    static struct cic cic;
    int32_t held = 0;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 8 * N; i++) {
        int32_t turn = i & 511;
        held += (turn < 256 ? 128 - turn : turn - 384) + lcg_below(&s, 33) - 16;
        bits[i / 8] = bits[i / 8] << 1 | (held >= 0);
        held += held >= 0 ? -200 : 200;
    }

    CYC_READ(c0);
    pdm_decimate(bits, N / 2, &cic, out);
    pdm_decimate(bits + N / 2, N / 2, &cic, out + N / 8);
    CYC_READ(c1);

    h = fnv_i16(h, out, N / 4);
    h = fnv_i32(h, cic.sums, 3);
    h = fnv_i32(h, cic.before, 3);
    h = fnv_i32(h, &cic.steady, 1);
    report("pdm_decimate", c1 - c0, h);
    PARAMS(SEED, 8 * N, "bit");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
