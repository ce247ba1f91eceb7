/* The point of a tree that is nearest to another one; each point halves the plane, across or along. */
#include "ref.h"
#include <stddef.h>

#define SEED 3042u
#define N 120
#define QUERIES 40
#define DEPTH 40

struct node {
    int16_t at[2];
    uint8_t axis;
    const struct node *halves[2]; /* below it, and from it on */
};

struct put_off {
    const struct node *node;
    int32_t gap;
};

KERNEL const struct node *kd_nearest(const struct node *tree, int32_t x, int32_t y)
{
    struct put_off stack[DEPTH], *top = stack;
    const struct node *nearest = NULL;
    int32_t least = INT32_MAX;

    *top++ = (struct put_off){tree, 0};
    while (top > stack) {
        const struct node *node = (--top)->node;
        if (top->gap >= least)
            continue;
        while (node) {
            int32_t dx = x - node->at[0], dy = y - node->at[1];
            int32_t square = dx * dx + dy * dy;
            if (square < least) {
                least = square;
                nearest = node;
            }
            int32_t off = node->axis ? dy : dx;
            const struct node *far = node->halves[off < 0];
            if (far && off * off < least) {
                top->node = far;
                top->gap = off * off;
                top++;
            }
            node = node->halves[off >= 0];
        }
    }
    return nearest;
}

static void insert(struct node *tree, struct node *node)
{
    for (;;) {
        const struct node **half = &tree->halves[node->at[tree->axis] >= tree->at[tree->axis]];
        if (!*half) {
            *half = node;
            node->axis = !tree->axis;
            return;
        }
        tree = (struct node *)*half;
    }
}

int main(void)
{
    static struct node nodes[N];
    static int16_t nearest[QUERIES];
    uint32_t s = SEED, c0, c1, cycles = 0, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t axis = 0; axis < 2; axis++)
        for (int32_t i = 0; i < N; i++)
            nodes[i].at[axis] = lcg_below(&s, 1000);
    for (int32_t i = 1; i < N; i++)
        insert(nodes, &nodes[i]);

    for (int32_t i = 0; i < QUERIES; i++) {
        int32_t x = lcg_below(&s, 1000), y = lcg_below(&s, 1000);
        CYC_READ(c0);
        nearest[i] = kd_nearest(nodes, x, y) - nodes;
        CYC_READ(c1);
        cycles += c1 - c0;
    }

    h = fnv_i16(h, nearest, QUERIES);
    report("kd_nearest", cycles, h);
    PARAMS(SEED, QUERIES, "query");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
