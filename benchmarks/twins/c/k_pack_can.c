/* Signals of a CAN frame, the least significant bit first; those beyond their bits are limited. */
#include "ref.h"
#include <string.h>

#define SEED 2941u
#define FRAMES 20
#define SIGNALS 7

struct signal {
    int32_t offset, scale;
    uint8_t start, length;
};

KERNEL void pack_can(const int32_t *values, const struct signal *signals, int32_t n, uint8_t data[8])
{
    memset(data, 0, 8);
    for (int32_t s = 0; s < n; s++) {
        const struct signal *signal = &signals[s];
        int32_t left = signal->length, bit = signal->start;
        int32_t raw = (values[s] - signal->offset) / signal->scale;
        int32_t most = (1 << left) - 1;
        if (raw < 0)
            raw = 0;
        if (raw > most)
            raw = most;
        while (left > 0) {
            int32_t shift = bit & 7;
            int32_t room = 8 - shift < left ? 8 - shift : left;
            data[bit >> 3] |= (raw & ((1 << room) - 1)) << shift;
            raw >>= room;
            bit += room;
            left -= room;
        }
    }
}

int main(void)
{
    static const struct signal signals[SIGNALS] = {{-4000, 2, 0, 12},   {-100, 1, 12, 10}, {0, 1, 22, 2}, {-32768, 1, 24, 16},
                                                   {-40, 2, 40, 7},     {0, 5, 47, 16},    {0, 1, 63, 1}};
    static const uint32_t limits[SIGNALS] = {9000, 1100, 4, 65536, 240, 65536, 2};
    static int32_t values[FRAMES][SIGNALS];
    static uint8_t data[FRAMES][8];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t f = 0; f < FRAMES; f++)
        for (int32_t i = 0; i < SIGNALS; i++)
            values[f][i] = lcg_below(&s, limits[i]) + signals[i].offset;

    CYC_READ(c0);
    for (int32_t f = 0; f < FRAMES; f++)
        pack_can(values[f], signals, SIGNALS, data[f]);
    CYC_READ(c1);

    h = fnv_u8(h, data[0], 8 * FRAMES);
    report("pack_can", c1 - c0, h);
    PARAMS(SEED, FRAMES * SIGNALS, "signal");
    PARAM("frames", FRAMES);
    PARAMS_END();
    return 0;
}
