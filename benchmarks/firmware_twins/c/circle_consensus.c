/* Twin of tinyphoon/stages/circle_consensus.py: `find_consensus`, `agree_on_side`. */
#include "circle_consensus.h"
#include "arithmetic.h"
#include "circle_edges.h"
#include "circle_fit.h"

#define TRIPLES 48
#define MOST_JUDGES 64

HELPER int32_t is_near(uint32_t edge, int32_t x, int32_t y, int32_t radius)
{
    int32_t near = near_of(radius);
    uint32_t inner = (uint32_t)max(radius - near, 0);
    uint32_t outer = (uint32_t)(radius + near);
    int32_t dx = FINE * edge_x(edge) - x;
    int32_t dy = FINE * edge_y(edge) - y;
    uint32_t square = (uint32_t)(dx * dx) + (uint32_t)(dy * dy);
    return inner * inner <= square && square <= outer * outer ? 1 : 0;
}

HELPER int32_t agreeing(const uint32_t selected[], int32_t count, int32_t x, int32_t y, int32_t radius)
{
    int32_t stride = floor_div(count + MOST_JUDGES - 1, MOST_JUDGES);
    int32_t found = 0;
    int32_t judges = 0;
    int32_t number = 0;
    while (number < count) {
        found = found + is_near(selected[number], x, y, radius);
        judges = judges + 1;
        number = number + stride;
    }
    return floor_div(found << 8, judges);
}

HELPER int32_t in_fine(int32_t number, int32_t divisor)
{
    int32_t whole = floor_div(number, divisor);
    return FINE * whole + floor_div(FINE * (number - whole * divisor), divisor);
}

HELPER int32_t try_triple(const uint32_t selected[], int32_t count, int32_t first, int32_t second, int32_t third,
                          const int32_t area[], int32_t fit[], int32_t best)
{
    int32_t x = edge_x(selected[first]);
    int32_t y = edge_y(selected[first]);
    int32_t x2 = edge_x(selected[second]) - x;
    int32_t y2 = edge_y(selected[second]) - y;
    int32_t x3 = edge_x(selected[third]) - x;
    int32_t y3 = edge_y(selected[third]) - y;
    int32_t twice = 2 * (x2 * y3 - y2 * x3);
    if (twice == 0)
        return best;
    int32_t square2 = x2 * x2 + y2 * y2;
    int32_t square3 = x3 * x3 + y3 * y3;
    int32_t right = y3 * square2 - y2 * square3;
    int32_t down = x2 * square3 - x3 * square2;
    if (twice < 0) {
        twice = -twice;
        right = -right;
        down = -down;
    }
    if (abs(x + floor_div(right, twice) - area[MASS_X]) > area[REACH]
        || abs(y + floor_div(down, twice) - area[MASS_Y]) > area[REACH])
        return best;
    int32_t dx = in_fine(right, twice);
    int32_t dy = in_fine(down, twice);
    int32_t radius = (int32_t)isqrt32((uint32_t)(dx * dx) + (uint32_t)(dy * dy));
    int32_t agree = agreeing(selected, count, FINE * x + dx, FINE * y + dy, radius);
    if (agree <= best)
        return best;
    fit[CENTRE_X] = FINE * x + dx;
    fit[CENTRE_Y] = FINE * y + dy;
    fit[RADIUS] = radius;
    return agree;
}

KERNEL int32_t find_consensus(const uint32_t selected[], int32_t count, const int32_t area[], int32_t fit[])
{
    int32_t best = 0;
    if (fit[RADIUS] > 0)
        best = agreeing(selected, count, fit[CENTRE_X], fit[CENTRE_Y], fit[RADIUS]);
    for (int32_t number = 0; number < TRIPLES; number++) {
        int32_t first = floor_div(number * count, TRIPLES);
        int32_t second = floor_mod(first + floor_div(count, 3) + number, count);
        int32_t third = floor_mod(first + floor_div(2 * count, 3) + 3 * number, count);
        best = try_triple(selected, count, first, second, third, area, fit, best);
    }
    return best;
}

KERNEL int32_t agree_on_side(uint32_t selected[], int32_t count, const int32_t area[], int32_t fit[])
{
    int32_t away = 0;
    for (int32_t number = 0; number < count; number++)
        away = away + looks_away(selected[number]);
    int32_t side = 2 * away > count ? 1 : 0;
    int32_t fewer = min(away, count - away);
    if (fewer == 0)
        return count;
    fit[RADIUS] = 0;
    find_consensus(selected, count, area, fit);
    int32_t agree = 0;
    for (int32_t number = 0; number < count; number++) {
        uint32_t edge = selected[number];
        if (looks_away(edge) != side)
            agree = agree + is_near(edge, fit[CENTRE_X], fit[CENTRE_Y], fit[RADIUS]);
    }
    if (fit[RADIUS] > 0 && 4 * agree >= 3 * fewer)
        return count;
    int32_t left = 0;
    for (int32_t number = 0; number < count; number++) {
        uint32_t edge = selected[number];
        if (looks_away(edge) == side) {
            selected[left] = edge;
            left = left + 1;
        }
    }
    return left;
}
