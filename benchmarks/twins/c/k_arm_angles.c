/* Angles of shoulder and elbow that bring the hand to points; where it cannot go it stays. How many it reaches. */
#include "ref.h"
#include <stdlib.h>

#define SEED 3032u
#define N 60
#define UPPER 150
#define FORE 110
#define KNOTS 66
#define HALF_TURN 2048
#define ONE 4096

struct point {
    int16_t x, y;
};

struct pose {
    int16_t shoulder, elbow;
};

HELPER int32_t newton_root(int32_t v)
{
    if (v < 2)
        return v > 0 ? v : 0;
    int32_t root = 1;
    for (int32_t left = v; left > 3; left >>= 2)
        root <<= 1;
    root <<= 1;
    for (;;) {
        int32_t better = (root + v / root) >> 1;
        if (better >= root)
            return root;
        root = better;
    }
}

/* The angle of a vector, 4096 a turn, by a table of one octant. */
HELPER int32_t angle_of(int32_t x, int32_t y, const int16_t *arctans)
{
    int32_t wide = abs(x), high = abs(y);
    if (wide == 0 && high == 0)
        return 0;
    int32_t slope = high > wide ? (wide << 10) / high : (high << 10) / wide;
    const int16_t *knot = arctans + (slope >> 4);
    int32_t angle = knot[0] + (((knot[1] - knot[0]) * (slope & 15) + 8) >> 4);
    if (high > wide)
        angle = HALF_TURN / 2 - angle;
    if (x < 0)
        angle = HALF_TURN - angle;
    return y < 0 ? -angle : angle;
}

KERNEL int32_t arm_angles(const struct point *points, int32_t n, int32_t upper, int32_t fore, const int16_t *arctans,
                          struct pose *poses)
{
    struct pose pose = {0, 0};
    const int32_t longest = upper + fore, shortest = upper - fore;
    int32_t reached = 0;

    for (int32_t i = 0; i < n; i++) {
        int32_t x = points[i].x, y = points[i].y;
        int32_t square = x * x + y * y;
        if (square <= longest * longest && square >= shortest * shortest) {
            int32_t cosine = ((square - upper * upper - fore * fore) * (ONE / 2)) / (upper * fore);
            int32_t sine = newton_root(ONE * ONE - cosine * cosine);
            pose.elbow = angle_of(cosine, sine, arctans);
            int32_t inner = angle_of((upper * ONE + fore * cosine) >> 6, (fore * sine) >> 6, arctans);
            int32_t shoulder = angle_of(x, y, arctans) - inner;
            pose.shoulder = shoulder < -HALF_TURN ? shoulder + 2 * HALF_TURN : shoulder;
            reached++;
        }
        poses[i] = pose;
    }
    return reached;
}

int main(void)
{
    static int16_t arctans[KNOTS];
    static struct point points[N];
    static struct pose poses[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t k = 0; k < KNOTS; k++)
        arctans[k] = k * (512 * 64 + 178 * (64 - k)) >> 12;
    for (int32_t i = 0; i < N; i++)
        points[i].x = lcg_below(&s, 461) - 230;
    for (int32_t i = 0; i < N; i++)
        points[i].y = lcg_below(&s, 461) - 230;

    CYC_READ(c0);
    int32_t reached = arm_angles(points, N, UPPER, FORE, arctans, poses);
    CYC_READ(c1);

    for (int32_t i = 0; i < N; i++)
        h = fnv_i16(h, &poses[i].shoulder, 1);
    for (int32_t i = 0; i < N; i++)
        h = fnv_i16(h, &poses[i].elbow, 1);
    h = fnv_i32(h, &reached, 1);
    report("arm_angles", c1 - c0, h);
    PARAMS(SEED, N, "point");
    PARAM("upper", UPPER);
    PARAM("fore", FORE);
    PARAMS_END();
    return 0;
}
