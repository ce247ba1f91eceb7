/* The marker of 4 x 4 bits in a black frame under a homography: four times its number, and its quarter turns; or -1. */
#include "ref.h"
#include <stdbool.h>
#include <string.h>

#define SEED 3014u
#define W 48
#define H 48
#define CELLS 6
#define CODES 16
#define MARKERS 8
#define MOST_OFF 2

HELPER uint32_t quarter_turned(uint32_t code)
{
    uint32_t turned = 0;
    for (int32_t column = 0; column < 4; column++)
        for (int32_t row = 3; row >= 0; row--)
            turned = turned << 1 | (code >> (15 - 4 * row - column) & 1);
    return turned;
}

KERNEL int32_t read_marker(const uint8_t *picture, int32_t w, int32_t h, const int32_t plane[3][3], int32_t threshold,
                           const uint16_t *codes, int32_t n)
{
    uint32_t code = 0;
    int32_t least = MOST_OFF + 1, best = -1;

    for (int32_t row = 0; row < CELLS; row++) {
        for (int32_t column = 0; column < CELLS; column++) {
            int32_t u = 2 * column + 1, v = 2 * row + 1;
            int32_t z = plane[2][0] * u + plane[2][1] * v + plane[2][2];
            int32_t x = (plane[0][0] * u + plane[0][1] * v + plane[0][2]) / z;
            int32_t y = (plane[1][0] * u + plane[1][1] * v + plane[1][2]) / z;
            if (x < 0 || y < 0 || x >= w || y >= h)
                return -1;
            bool white = picture[y * w + x] > threshold;
            bool frame = row == 0 || row == CELLS - 1 || column == 0 || column == CELLS - 1;
            if (!frame)
                code = code << 1 | white;
            else if (white)
                return -1;
        }
    }
    for (int32_t turn = 0; turn < 4; turn++) {
        for (int32_t i = 0; i < n; i++) {
            int32_t off = 0;
            for (uint32_t different = code ^ codes[i]; different; different &= different - 1)
                off++;
            if (off < least) {
                least = off;
                best = 4 * i + turn;
            }
        }
        code = quarter_turned(code);
    }
    return best;
}

int main(void)
{
    static uint8_t picture[H][W];
    static uint16_t codes[CODES];
    static int32_t found[MARKERS];
    static const int32_t upright[2][3] = {{3072, 0, 2048}, {0, 3072, 2048}};
    static const int32_t on_its_side[2][3] = {{0, -3072, 38 * 1024}, {3072, 0, 2048}};
    uint32_t s = SEED, c0, c1, cycles = 0, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < CODES; i++)
        codes[i] = lcg_below(&s, 65536);

    for (int32_t i = 0; i < MARKERS; i++) {
        int32_t plane[3][3];
        for (int32_t y = 0; y < H; y++)
            for (int32_t x = 0; x < W; x++)
                picture[y][x] = lcg_below(&s, 60);
        uint32_t code = codes[lcg_below(&s, CODES)];
        code ^= 1u << lcg_below(&s, 16);
        for (int32_t y = 0; y < 24; y++)
            for (int32_t x = 0; x < 24; x++)
                if (code >> (15 - 4 * (y / 6) - x / 6) & 1)
                    picture[y + 8][x + 8] = 150 + lcg_below(&s, 100);
        memcpy(plane, i & 1 ? on_its_side : upright, sizeof upright);
        plane[2][0] = lcg_below(&s, 8);
        plane[2][1] = lcg_below(&s, 8);
        plane[2][2] = 1024;

        CYC_READ(c0);
        found[i] = read_marker(picture[0], W, H, plane, 100, codes, CODES);
        CYC_READ(c1);
        cycles += c1 - c0;
    }

    h = fnv_i32(h, found, MARKERS);
    report("read_marker", cycles, h);
    PARAMS(SEED, MARKERS, "marker");
    PARAM("n", CODES);
    PARAMS_END();
    return 0;
}
