/* Descriptors of points in 64 bits: which of two pixels is brighter, turned as the point is (32 a turn). */
#include "ref.h"

#define SEED 3013u
#define W 48
#define H 40
#define N 10
#define MARGIN 13
#define TURN 32

struct place {
    int8_t x, y;
};

struct pair {
    struct place first, second;
};

struct corner {
    int16_t x, y;
    uint8_t turn;
};

HELPER int32_t turned_offset(const struct place *place, int32_t sine, int32_t cosine, int32_t w)
{
    int32_t u = (place->x * cosine - place->y * sine + 8192) >> 14;
    int32_t v = (place->x * sine + place->y * cosine + 8192) >> 14;
    return v * w + u;
}

KERNEL void brief_words(const uint8_t *picture, int32_t w, const struct corner *corner, int32_t n, const struct pair pairs[64],
                        const int16_t sines[TURN], uint32_t (*words)[2])
{
    for (const struct corner *end = corner + n; corner < end; corner++, words++) {
        const uint8_t *here = picture + corner->y * w + corner->x;
        int32_t sine = sines[corner->turn], cosine = sines[(corner->turn + TURN / 4) % TURN];
        const struct pair *pair = pairs;
        for (int32_t k = 0; k < 2; k++) {
            uint32_t bits = 0;
            for (int32_t j = 0; j < 32; j++, pair++) {
                uint8_t first = here[turned_offset(&pair->first, sine, cosine, w)];
                uint8_t second = here[turned_offset(&pair->second, sine, cosine, w)];
                bits = bits << 1 | (first < second);
            }
            (*words)[k] = bits;
        }
    }
}

int main(void)
{
    static uint8_t picture[W * H];
    static struct pair pairs[64];
    static struct corner corners[N];
    static int16_t sines[TURN];
    static uint32_t words[N][2];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < TURN; i++) {
        int32_t turn = i % (TURN / 2), sine = 256 * turn * (16 - turn);
        sines[i] = i < TURN / 2 ? sine : -sine;
    }
    for (int32_t i = 0; i < W * H; i++)
        picture[i] = lcg_u8(&s);
    for (int32_t i = 0; i < 64; i++) {
        pairs[i].first.x = lcg_below(&s, 17) - 8;
        pairs[i].first.y = lcg_below(&s, 17) - 8;
        pairs[i].second.x = lcg_below(&s, 17) - 8;
        pairs[i].second.y = lcg_below(&s, 17) - 8;
    }
    for (int32_t i = 0; i < N; i++)
        corners[i].x = lcg_below(&s, W - 2 * MARGIN) + MARGIN;
    for (int32_t i = 0; i < N; i++)
        corners[i].y = lcg_below(&s, H - 2 * MARGIN) + MARGIN;
    for (int32_t i = 0; i < N; i++)
        corners[i].turn = lcg_below(&s, TURN);

    CYC_READ(c0);
    brief_words(picture, W, corners, N, pairs, sines, words);
    CYC_READ(c1);

    h = fnv_u32(h, words[0], 2 * N);
    report("brief_words", c1 - c0, h);
    PARAMS(SEED, 64 * N, "bit");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
