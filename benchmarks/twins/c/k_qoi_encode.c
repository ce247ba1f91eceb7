/* A picture as the "quite OK image format" has it: runs, colours seen before, small differences; returns its bytes. */
#include "ref.h"
#include <string.h>

#define SEED 3043u
#define N 400
#define LONGEST_RUN 62

enum { INDEX = 0x00, DIFFERENCE = 0x40, LUMA = 0x80, REPEAT = 0xC0, COLOUR = 0xFE };

struct rgb {
    uint8_t r, g, b;
};

static inline uint32_t packed(struct rgb p)
{
    return (uint32_t)p.r << 16 | p.g << 8 | p.b;
}

KERNEL int32_t qoi_encode(const struct rgb *pixels, int32_t n, uint8_t *out)
{
    uint32_t known[64];
    struct rgb before = {0, 0, 0};
    uint8_t *to = out;
    int32_t repeats = 0;

    memset(known, 0xFF, sizeof known);
    for (const struct rgb *end = pixels + n; pixels < end; pixels++) {
        struct rgb p = *pixels;
        uint32_t colour = packed(p);
        if (colour == packed(before)) {
            if (++repeats == LONGEST_RUN) {
                *to++ = REPEAT | (repeats - 1);
                repeats = 0;
            }
            continue;
        }
        if (repeats > 0) {
            *to++ = REPEAT | (repeats - 1);
            repeats = 0;
        }
        uint32_t place = (3 * p.r + 5 * p.g + 7 * p.b + 11 * 255) % 64;
        if (known[place] == colour) {
            *to++ = INDEX | place;
        } else {
            int8_t dr = p.r - before.r, dg = p.g - before.g, db = p.b - before.b;
            int32_t rg = dr - dg, bg = db - dg;
            known[place] = colour;
            if (dr >= -2 && dr <= 1 && dg >= -2 && dg <= 1 && db >= -2 && db <= 1) {
                *to++ = DIFFERENCE | (dr + 2) << 4 | (dg + 2) << 2 | (db + 2);
            } else if (dg >= -32 && dg <= 31 && rg >= -8 && rg <= 7 && bg >= -8 && bg <= 7) {
                *to++ = LUMA | (dg + 32);
                *to++ = (rg + 8) << 4 | (bg + 8);
            } else {
                *to++ = COLOUR;
                *to++ = p.r;
                *to++ = p.g;
                *to++ = p.b;
            }
        }
        before = p;
    }
    if (repeats > 0)
        *to++ = REPEAT | (repeats - 1);
    return to - out;
}

int main(void)
{
    static struct rgb pixels[N];
    static uint8_t out[4 * N];
    struct rgb p = {90, 120, 60};
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        int32_t kind = lcg_below(&s, 8);
        if (kind == 0) {
            p.r = lcg_u8(&s);
            p.g = lcg_u8(&s);
            p.b = lcg_u8(&s);
        } else if (kind < 3) {
            p.r += lcg_below(&s, 3) - 1;
            p.g += lcg_below(&s, 3) - 1;
            p.b += lcg_below(&s, 3) - 1;
        } else if (kind == 3) {
            int32_t step = lcg_below(&s, 21) - 12;
            p.r += step + lcg_below(&s, 5);
            p.g += step + lcg_below(&s, 5);
            p.b += step + lcg_below(&s, 5);
        } else if (kind == 4 && i > 9) {
            p = pixels[i - 9];
        }
        pixels[i] = p;
    }

    CYC_READ(c0);
    int32_t made = qoi_encode(pixels, N, out);
    CYC_READ(c1);

    h = fnv_u8(h, out, 4 * N);
    h = fnv_i32(h, &made, 1);
    report("qoi_encode", c1 - c0, h);
    PARAMS(SEED, N, "pixel");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
