/* Run lengths back to bytes: pairs of (count, value), a count of 0 ends. Returns the length. */
#include "ref.h"

#define SEED 1207u
#define RUNS 100
#define ROOM 1200

KERNEL int32_t rle_expand(const uint8_t code[], uint8_t out[], int32_t room)
{
    int32_t i = 0;
    int32_t n = 0;
    while (code[i] != 0) {
        int32_t run = code[i];
        int32_t value = code[i + 1];
        if (n + run > room) {
            run = room - n;
        }
        for (int32_t j = 0; j < run; j++) {
            out[n + j] = (uint8_t)value;
        }
        n += run;
        i += 2;
    }
    return n;
}

int main(void)
{
    static uint8_t code[2 * RUNS + 1], out[ROOM];
    int32_t n;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < RUNS; i++) {
        code[2 * i] = (uint8_t)(1 + lcg_below(&s, 15));
        code[2 * i + 1] = (uint8_t)lcg_u8(&s);
    }

    CYC_READ(c0);
    n = rle_expand(code, out, ROOM);
    CYC_READ(c1);

    h = fnv_u8(h, out, ROOM);
    h = fnv_val32(h, (uint32_t)n);
    report("rle_expand", c1 - c0, h);
    PARAMS(SEED, RUNS, "run");
    PARAM("runs", RUNS);
    PARAM("room", ROOM);
    PARAMS_END();
    return 0;
}
