/* The 13 digits of a bar code along a row: 0 if they are right, -1 to -4 for what is wrong. */
#include "ref.h"
#include <stdbool.h>

#define SEED 3024u
#define N 320
#define CODES 4
#define DIGITS 13
#define RUNS 59
#define THRESHOLD 125

enum { NO_BARS = -1, NO_DIGIT = -2, NO_FIRST = -3, WRONG_CHECK = -4 };

static const uint16_t shapes[10] = {0x3211, 0x2221, 0x2122, 0x1411, 0x1132, 0x1231, 0x1114, 0x1312, 0x1213, 0x3112};
static const uint8_t parities[10] = {0, 11, 13, 14, 19, 25, 28, 21, 22, 26};

/* The digit of four widths, ten more if it is the other way round; -1 if there is none. */
HELPER int32_t digit_of(const uint8_t *widths)
{
    int32_t total = widths[0] + widths[1] + widths[2] + widths[3];
    int32_t shape = 0, mirrored = 0;
    for (int32_t i = 0; i < 4; i++) {
        int32_t modules = (14 * widths[i] + total) / (2 * total);
        shape = shape << 4 | modules;
        mirrored |= modules << 4 * i;
    }
    for (int32_t digit = 0; digit < 10; digit++) {
        if (shapes[digit] == shape)
            return digit;
        if (shapes[digit] == mirrored)
            return digit + 10;
    }
    return -1;
}

KERNEL int32_t ean_digits(const uint8_t *row, int32_t n, int32_t threshold, uint8_t digits[DIGITS])
{
    const uint8_t *end = row + n;
    uint8_t widths[RUNS];
    int32_t runs = 0, width = 0;
    bool dark = true;

    while (row < end && *row >= threshold)
        row++;
    for (; row < end && runs < RUNS; row++) {
        if ((*row < threshold) != dark) {
            widths[runs++] = width;
            width = 0;
            dark = !dark;
        }
        width++;
    }
    if (runs < RUNS)
        return NO_BARS;

    const uint8_t *at = widths + 3;
    int32_t parity = 0;
    for (int32_t i = 1; i < DIGITS; i++, at += 4) {
        int32_t digit = digit_of(at);
        if (digit < 0)
            return NO_DIGIT;
        if (i <= 6) {
            parity <<= 1;
            if (digit >= 10) {
                parity |= 1;
                digit -= 10;
            }
        }
        digits[i] = digit;
        if (i == 6)
            at += 5;
    }

    int32_t first = 0;
    while (first < 10 && parities[first] != parity)
        first++;
    if (first == 10)
        return NO_FIRST;
    digits[0] = first;

    int32_t check = 0;
    for (int32_t i = 0; i < DIGITS; i++)
        check += i & 1 ? 3 * digits[i] : digits[i];
    return check % 10 == 0 ? 0 : WRONG_CHECK;
}

static uint8_t row[N];
static uint32_t s = SEED;

static uint8_t *draw(uint8_t *at, int32_t pixels, bool dark)
{
    for (; pixels > 0; pixels--, at++)
        if (dark)
            *at = 30 + lcg_below(&s, 60);
    return at;
}

int main(void)
{
    static uint8_t read[CODES][DIGITS];
    static int32_t results[CODES];
    uint32_t c0, c1, cycles = 0, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t code = 0; code < CODES; code++) {
        int32_t digits[DIGITS], check = 0, pixels = 2 + (code & 1);
        for (int32_t i = 0; i < DIGITS - 1; i++) {
            digits[i] = lcg_below(&s, 10);
            check += (i & 1 ? 3 : 1) * digits[i];
        }
        digits[12] = (10 - check % 10 + (code == 3 ? 5 : 0)) % 10;

        uint8_t *at = row + 10 + lcg_below(&s, 20);
        for (int32_t x = 0; x < N; x++)
            row[x] = 160 + lcg_below(&s, 60);
        bool dark = true;
        for (int32_t i = 0; i < 3; i++, dark = !dark)
            at = draw(at, pixels, dark);
        for (int32_t i = 1; i < DIGITS; i++) {
            bool mirrored = i < 7 && parities[digits[0]] >> (6 - i) & 1;
            for (int32_t k = 0; k < 4; k++, dark = !dark)
                at = draw(at, pixels * (shapes[digits[i]] >> (mirrored ? 4 * k : 12 - 4 * k) & 15), dark);
            if (i == 6)
                for (int32_t k = 0; k < 5; k++, dark = !dark)
                    at = draw(at, pixels, dark);
        }
        for (int32_t i = 0; i < 3; i++, dark = !dark)
            at = draw(at, pixels, dark);

        CYC_READ(c0);
        results[code] = ean_digits(row, N, THRESHOLD, read[code]);
        CYC_READ(c1);
        cycles += c1 - c0;
    }

    h = fnv_u8(h, read[0], CODES * DIGITS);
    h = fnv_i32(h, results, CODES);
    report("ean_digits", cycles, h);
    PARAMS(SEED, CODES, "row");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
