/* Keep the points that a line between its neighbours would miss by more than the tolerance (Douglas and Peucker). */
#include "ref.h"
#include <stdlib.h>

#define SEED 2912u
#define N 150

struct span {
    int16_t first, last;
};

KERNEL int32_t simplify_outline(const int16_t *xs, const int16_t *ys, int32_t n, int32_t tolerance, uint8_t *keep,
                                struct span *stack)
{
    for (int32_t i = 0; i < n; i++)
        keep[i] = 0;
    keep[0] = keep[n - 1] = 1;
    int32_t kept = 2, top = 0;
    stack[top].first = 0;
    stack[top++].last = n - 1;
    while (top > 0) {
        top--;
        int32_t first = stack[top].first, last = stack[top].last;
        int32_t dx = xs[last] - xs[first];
        int32_t dy = ys[last] - ys[first];
        int32_t most = -1, farthest = first;
        for (int32_t i = first + 1; i < last; i++) {
            int32_t off = abs(dx * (ys[i] - ys[first]) - dy * (xs[i] - xs[first]));
            if (off > most) {
                most = off;
                farthest = i;
            }
        }
        dx = abs(dx);
        dy = abs(dy);
        int32_t length = dx > dy ? dx + dy / 2 : dy + dx / 2;
        if (most > tolerance * length) {
            keep[farthest] = 1;
            kept++;
            if (farthest - first > 1) {
                stack[top].first = first;
                stack[top++].last = farthest;
            }
            if (last - farthest > 1) {
                stack[top].first = farthest;
                stack[top++].last = last;
            }
        }
    }
    return kept;
}

int main(void)
{
    static const int8_t ahead[4][2] = {{2, 0}, {0, 2}, {-2, 0}, {0, -2}};
    static int16_t xs[N], ys[N];
    static uint8_t keep[N];
    static struct span stack[N];
    int32_t x = 160, y = 40;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        x += ahead[i / 38][0] + lcg_below(&s, 3) - 1;
        y += ahead[i / 38][1] + lcg_below(&s, 3) - 1;
        xs[i] = x;
        ys[i] = y;
    }

    CYC_READ(c0);
    int32_t kept = simplify_outline(xs, ys, N, 3, keep, stack);
    CYC_READ(c1);

    h = fnv_u8(h, keep, N);
    h = fnv_i32(h, &kept, 1);
    report("simplify_outline", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
