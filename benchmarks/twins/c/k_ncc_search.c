/* Where a template is most alike, whatever the light; scores in 255ths, 0 where the picture is flat. */
#include "ref.h"

#define SEED 3011u
#define W 24
#define H 14
#define SIDE 8
#define POSITIONS ((W - SIDE + 1) * (H - SIDE + 1))
#define FLAT 25 /* variance */

HELPER int32_t square_root(int32_t v)
{
    int32_t root = 0, bit = 1 << 28;
    while (bit > v)
        bit >>= 2;
    for (; bit > 0; bit >>= 2) {
        int32_t trial = root + bit;
        root >>= 1;
        if (v >= trial) {
            v -= trial;
            root += bit;
        }
    }
    return root;
}

KERNEL int32_t ncc_search(const uint8_t *picture, int32_t w, int32_t h, const uint8_t *template, int32_t side, uint8_t *scores)
{
    const int32_t area = side * side;
    int32_t mean = 0, own = 0, most = 0, best = -1, at = 0;

    for (int32_t i = 0; i < area; i++) {
        mean += template[i];
        own += template[i] * template[i];
    }
    own = square_root(area * own - mean * mean);

    for (int32_t y = 0; y <= h - side; y++) {
        for (int32_t x = 0; x <= w - side; x++, at++) {
            const uint8_t *row = picture + y * w + x, *t = template;
            int32_t total = 0, squares = 0, products = 0;
            for (int32_t v = 0; v < side; v++, row += w) {
                for (int32_t u = 0; u < side; u++) {
                    int32_t p = row[u];
                    total += p;
                    squares += p * p;
                    products += p * *t++;
                }
            }
            int32_t likeness = area * products - total * mean;
            int32_t spread = area * squares - total * total;
            int32_t score = 0;
            if (likeness > 0 && spread > FLAT * area * area) {
                int32_t scale = own * square_root(spread) >> 8;
                score = likeness / (scale > 0 ? scale : 1);
                if (score > 255)
                    score = 255;
            }
            scores[at] = score;
            if (score > most) {
                most = score;
                best = at;
            }
        }
    }
    return best;
}

int main(void)
{
    static uint8_t picture[H][W], template[SIDE][SIDE], scores[POSITIONS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t v = 0; v < SIDE; v++)
        for (int32_t u = 0; u < SIDE; u++)
            template[v][u] = lcg_u8(&s);
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++)
            picture[y][x] = lcg_below(&s, 60) + 100;
    for (int32_t v = 0; v < SIDE; v++)
        for (int32_t u = 0; u < SIDE; u++)
            picture[v + 3][u + 11] = 40 + (template[v][u] >> 1) + lcg_below(&s, 20);

    CYC_READ(c0);
    int32_t best = ncc_search(picture[0], W, H, template[0], SIDE, scores);
    CYC_READ(c1);

    h = fnv_u8(h, scores, POSITIONS);
    h = fnv_i32(h, &best, 1);
    report("ncc_search", c1 - c0, h);
    PARAMS(SEED, POSITIONS, "position");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("side", SIDE);
    PARAMS_END();
    return 0;
}
