/* Windows of 20 x 20 that pass every stage; a feature compares a box with a part of it. */
#include "ref.h"

#define SEED 2911u
#define W 64
#define H 48
#define STRIDE (W + 1)
#define FEATURES 18
#define STAGES 3
#define SIDE 20

struct box {
    uint8_t x, y, w, h;
};

struct boxes {
    struct box whole, part;
};

struct votes {
    int16_t limit, below, above;
};

HELPER int32_t box_sum(const int32_t *window, int32_t stride, const struct box *box)
{
    const int32_t *above = window + box->y * stride + box->x;
    const int32_t *below = above + box->h * stride;
    return below[box->w] - below[0] - above[box->w] + above[0];
}

KERNEL int32_t cascade_windows(const int32_t *sums, int32_t stride, int32_t rows, const struct boxes *boxes,
                               const struct votes *votes, const uint8_t *ends, const int16_t *passes, int32_t stages,
                               int32_t *found)
{
    int32_t hits = 0;
    for (int32_t y = 0; y < rows - SIDE; y += 4) {
        for (int32_t x = 0; x < stride - SIDE; x += 4) {
            const int32_t *window = sums + y * stride + x;
            int32_t feature = 0, stage;
            for (stage = 0; stage < stages; stage++) {
                int32_t score = 0;
                for (; feature < ends[stage]; feature++) {
                    int32_t whole = box_sum(window, stride, &boxes[feature].whole);
                    int32_t part = box_sum(window, stride, &boxes[feature].part);
                    if (2 * part - whole < votes[feature].limit)
                        score += votes[feature].below;
                    else
                        score += votes[feature].above;
                }
                if (score < passes[stage])
                    break;
            }
            if (stage == stages)
                found[hits++] = y * stride + x;
        }
    }
    return hits;
}

int main(void)
{
    static int32_t sums[(H + 1) * STRIDE], found[100];
    static struct boxes boxes[FEATURES];
    static struct votes votes[FEATURES];
    static const uint8_t ends[STAGES] = {3, 9, 18};
    static const int16_t passes[STAGES] = {130, 310, 440};
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t y = 0; y < H; y++) {
        int32_t line = 0;
        for (int32_t x = 0; x < W; x++) {
            line += lcg_u8(&s);
            sums[(y + 1) * STRIDE + x + 1] = sums[y * STRIDE + x + 1] + line;
        }
    }
    for (int32_t i = 0; i < FEATURES; i++) {
        struct box *whole = &boxes[i].whole, *part = &boxes[i].part;
        whole->x = lcg_below(&s, 8);
        whole->y = lcg_below(&s, 8);
        whole->w = 4 + lcg_below(&s, 8);
        whole->h = 4 + lcg_below(&s, 8);
        part->x = whole->x + whole->w / 4;
        part->y = whole->y;
        part->w = whole->w / 2;
        part->h = whole->h;
        votes[i].limit = lcg_below(&s, 400) - 200;
        votes[i].below = lcg_below(&s, 100);
        votes[i].above = lcg_below(&s, 100);
    }

    CYC_READ(c0);
    int32_t hits = cascade_windows(sums, STRIDE, H + 1, boxes, votes, ends, passes, STAGES, found);
    CYC_READ(c1);

    h = fnv_i32(h, found, 100);
    h = fnv_i32(h, &hits, 1);
    report("cascade_windows", c1 - c0, h);
    PARAMS(SEED, 96, "window");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
