/* Messages of a ring of bytes: 0xA5, length, payload, sum.  Returns what has been read up to. */
#include "ref.h"

#define SEED 2832u
#define SIZE 512
#define MESSAGES 16

KERNEL int32_t parse_ring(const uint8_t ring[], int32_t mask, int32_t tail, int32_t head, uint8_t payload[], int32_t counts[5])
{
    for (;;) {
        int32_t available = (head - tail) & mask;
        if (available < 4)
            break;
        if (ring[tail] != 0xA5) {
            tail = (tail + 1) & mask;
            continue;
        }
        int32_t length = ring[(tail + 1) & mask];
        if (length > 24) {
            tail = (tail + 1) & mask;
            continue;
        }
        if (available < length + 3)
            break;
        uint8_t check = length;
        for (int32_t i = 0; i < length; i++) {
            payload[i] = ring[(tail + 2 + i) & mask];
            check += payload[i];
        }
        if (check == ring[(tail + 2 + length) & mask]) {
            counts[payload[0] & 3]++;
            tail = (tail + length + 3) & mask;
        } else {
            counts[4]++;
            tail = (tail + 1) & mask;
        }
    }
    return tail;
}

int main(void)
{
    static uint8_t ring[SIZE], payload[24];
    static int32_t counts[5];
    int32_t at = 400, tail;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t m = 0; m < MESSAGES; m++) {
        int32_t garbage = lcg_below(&s, 3);
        for (int32_t i = 0; i < garbage; i++)
            ring[at++ & (SIZE - 1)] = (uint8_t)lcg_u8(&s);
        int32_t length = 1 + lcg_below(&s, 20), check = length;
        ring[at++ & (SIZE - 1)] = 0xA5;
        ring[at++ & (SIZE - 1)] = (uint8_t)length;
        for (int32_t i = 0; i < length; i++) {
            int32_t byte = lcg_u8(&s);
            ring[at++ & (SIZE - 1)] = (uint8_t)byte;
            check += byte;
        }
        ring[at++ & (SIZE - 1)] = (uint8_t)(check + (lcg_below(&s, 6) == 0));
    }

    CYC_READ(c0);
    tail = parse_ring(ring, SIZE - 1, 400, at & (SIZE - 1), payload, counts);
    CYC_READ(c1);

    h = fnv_u8(h, payload, 24);
    h = fnv_i32(h, counts, 5);
    h = fnv_val32(h, (uint32_t)tail);
    report("parse_ring", c1 - c0, h);
    PARAMS(SEED, MESSAGES, "message");
    PARAM("size", SIZE);
    PARAMS_END();
    return 0;
}
