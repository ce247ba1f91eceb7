/* Move a window (middle and half of its size) to where a map is densest; returns the turns that it took. */
#include "ref.h"

#define SEED 3012u
#define W 64
#define H 40
#define TURNS 12
#define FAINT 32

struct window {
    int16_t x, y, half_w, half_h;
};

KERNEL int32_t mean_shift(const uint8_t *likely, int32_t w, int32_t h, struct window *window, int32_t most)
{
    int32_t turns = 0;

    while (turns < most) {
        int32_t x = window->x, y = window->y;
        int32_t left = x - window->half_w, right = x + window->half_w;
        int32_t top = y - window->half_h, bottom = y + window->half_h;
        int32_t mass = 0, sum_x = 0, sum_y = 0;

        if (left < 0)
            left = 0;
        if (top < 0)
            top = 0;
        if (right >= w)
            right = w - 1;
        if (bottom >= h)
            bottom = h - 1;
        turns++;
        for (int32_t v = top; v <= bottom; v++) {
            const uint8_t *row = likely + v * w;
            int32_t line = 0;
            for (int32_t u = left; u <= right; u++) {
                if (row[u] > FAINT) {
                    line += row[u];
                    sum_x += row[u] * (u - x);
                }
            }
            mass += line;
            sum_y += line * (v - y);
        }
        if (mass == 0)
            break;

        int32_t dx = sum_x / mass, dy = sum_y / mass;
        if (dx == 0 && dy == 0)
            break;
        window->x = x + dx;
        window->y = y + dy;
    }
    return turns;
}

int main(void)
{
    static uint8_t likely[H][W];
    static struct window window = {30, 12, 9, 8};
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++)
            likely[y][x] = lcg_below(&s, 48);
    for (int32_t y = 18; y < 33; y++)
        for (int32_t x = 36; x < 54; x++)
            likely[y][x] = 120 + lcg_below(&s, 100);

    CYC_READ(c0);
    int32_t turns = mean_shift(likely[0], W, H, &window, TURNS);
    CYC_READ(c1);

    h = fnv_i16(h, &window.x, 4);
    h = fnv_i32(h, &turns, 1);
    report("mean_shift", c1 - c0, h);
    PARAMS(SEED, 7, "turn");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
