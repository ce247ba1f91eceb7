/* Starts, stops, addresses and data of an I2C bus, with the acknowledge in bit 8; bit 0 is the clock, bit 1 the data. */
#include "ref.h"
#include <stdbool.h>

#define SEED 3023u
#define TRANSFERS 6
#define MOST_SAMPLES 3000
#define MOST_EVENTS 64

enum { SCL = 1, SDA = 2 };
enum { START = 0x200, STOP = 0x400, ADDRESS = 0x800 };

KERNEL int32_t i2c_sniff(const uint8_t *samples, int32_t n, uint16_t *events)
{
    enum { IDLE = -1 };
    const uint8_t *end = samples + n;
    uint16_t *event = events;
    uint32_t before = SCL | SDA, value = 0, kind = 0;
    int32_t bits = IDLE;

    for (; samples < end; samples++) {
        uint32_t now = *samples & (SCL | SDA);
        bool data = now & SDA;
        if (now == before)
            continue;
        if (now & before & SCL) { /* data changed while the clock was high */
            if (data) {
                *event++ = STOP;
                bits = IDLE;
            } else {
                *event++ = START;
                kind = ADDRESS;
                value = 0;
                bits = 0;
            }
        } else if (now & SCL && bits != IDLE) { /* the clock rose */
            if (bits < 8) {
                value = value << 1 | data;
                bits++;
            } else {
                *event++ = kind | data << 8 | value;
                kind = 0;
                value = 0;
                bits = 0;
            }
        }
        before = now;
    }
    return event - events;
}

static uint8_t samples[MOST_SAMPLES];
static int32_t sampled;
static uint32_t s = SEED;

static void hold(uint8_t lines)
{
    lines |= 4 * lcg_below(&s, 2);
    for (int32_t left = 1 + lcg_below(&s, 3); left > 0; left--)
        samples[sampled++] = lines;
}

static void clock(uint8_t bit)
{
    hold(2 * bit);
    hold(2 * bit + 1);
    hold(2 * bit);
}

int main(void)
{
    static uint16_t events[MOST_EVENTS];
    uint32_t c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t transfer = 0; transfer < TRANSFERS; transfer++) {
        hold(3);
        hold(1);
        hold(0);
        for (int32_t left = 2 + lcg_below(&s, 4); left > 0; left--) {
            uint32_t octet = lcg_u8(&s);
            for (int32_t b = 7; b >= 0; b--)
                clock(octet >> b & 1);
            clock(lcg_below(&s, 8) == 0);
        }
        hold(0);
        hold(1);
        hold(3);
    }

    CYC_READ(c0);
    int32_t found = i2c_sniff(samples, sampled, events);
    CYC_READ(c1);

    h = fnv_u16(h, events, MOST_EVENTS);
    h = fnv_i32(h, &found, 1);
    report("i2c_sniff", c1 - c0, h);
    PARAMS(SEED, sampled, "sample");
    PARAM("transfers", TRANSFERS);
    PARAMS_END();
    return 0;
}
