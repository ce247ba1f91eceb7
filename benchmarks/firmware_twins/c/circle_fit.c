/* Twin of tinyphoon/stages/circle_fit.py: `fit_circle`, `near_of`. */
#include "circle_fit.h"
#include "arithmetic.h"
#include "circle_edges.h"
#include "line_fit.h"

#define NEAR_BITS 4
#define NOISE 256
#define SHADE 16
#define OUTSIDE_BITS 8
#define MOST 255
#define TAPER 64
#define TAPER_BITS 16
#define WEIGHT_BITS 9
#define NORMAL_BITS 7
#define BULGE_BITS 12
#define SHORTEST_ARC (1 << 10)
#define NEAR_POINTS 37
#define OWN_SQUARE (FINE / 6)
#define STILL 2

KERNEL int32_t distance(int32_t x, int32_t y, const int32_t fit[])
{
    int32_t dx = x - fit[CENTRE_X];
    int32_t dy = y - fit[CENTRE_Y];
    return (int32_t)isqrt32((uint32_t)(dx * dx) + (uint32_t)(dy * dy));
}

HELPER int32_t outside_of(int32_t nx, int32_t ny, int32_t away, const int32_t fit[])
{
    int32_t bulge = (fit[BULGE_COSINE] * (nx * nx - ny * ny) + 2 * fit[BULGE_SINE] * nx * ny) >> (2 * NORMAL_BITS);
    return away - fit[RADIUS] - (fit[RADIUS] * bulge >> BULGE_BITS);
}

KERNEL int32_t near_of(int32_t radius)
{
    return max(FINE, radius >> NEAR_BITS);
}

HELPER void weigh(uint16_t weights[], int32_t fit[])
{
    int32_t count = fit[REFINED];
    int32_t squares = 0;
    for (int32_t number = 0; number < count; number++)
        squares = squares + weights[number] * weights[number];
    int32_t mean = floor_div(squares, max(count, 1));
    for (int32_t number = 0; number < count; number++) {
        int32_t own = weights[number] * weights[number];
        int32_t noisy = own + NOISE;
        int32_t inside = floor_div(MOST * own, noisy + SHADE * max(mean - own, 0));
        weights[number] = (uint16_t)(inside | floor_div(MOST * own, noisy) << OUTSIDE_BITS);
    }
}

HELPER void sum_up(const uint32_t points[], const uint16_t weights[], int32_t count, int32_t fit[], int32_t fit_range)
{
    int32_t widest = fit_range * fit_range;
    int32_t scale = floor_div(TAPER << TAPER_BITS, widest);
    for (int32_t word = WEIGHT; word < SUM_NYE + 1; word++)
        fit[word] = 0;
    for (int32_t number = 0; number < count; number++) {
        int32_t x = (int32_t)(points[number] & 0xFFFF);
        int32_t y = (int32_t)(points[number] >> 16);
        int32_t away = max(distance(x, y, fit), 1);
        int32_t nx = floor_div((x - fit[CENTRE_X]) << NORMAL_BITS, away);
        int32_t ny = floor_div((y - fit[CENTRE_Y]) << NORMAL_BITS, away);
        int32_t outside = outside_of(nx, ny, away, fit);
        if (abs(outside) < fit_range) {
            int32_t near = (widest - outside * outside) * scale >> TAPER_BITS;
            int32_t counts = outside > 0 ? weights[number] >> OUTSIDE_BITS : weights[number] & MOST;
            int32_t weight = (near * counts + (1 << (WEIGHT_BITS - 1))) >> WEIGHT_BITS;
            fit[WEIGHT] = fit[WEIGHT] + weight;
            fit[SUM_NX] = fit[SUM_NX] + weight * nx;
            fit[SUM_NY] = fit[SUM_NY] + weight * ny;
            fit[SUM_NXX] = fit[SUM_NXX] + weight * nx * nx;
            fit[SUM_NXY] = fit[SUM_NXY] + weight * nx * ny;
            fit[SUM_NYY] = fit[SUM_NYY] + weight * ny * ny;
            fit[SUM_E] = fit[SUM_E] + weight * outside;
            fit[SUM_NXE] = fit[SUM_NXE] + weight * nx * outside;
            fit[SUM_NYE] = fit[SUM_NYE] + weight * ny * outside;
        }
    }
}

HELPER int32_t move_circle(int32_t fit[], int32_t fit_range)
{
    int32_t weight = fit[WEIGHT];
    if (weight == 0)
        return 0;
    int32_t xx = floor_div(spread(fit[SUM_NXX], fit[SUM_NX], fit[SUM_NX], weight), weight) >> 2;
    int32_t xy = floor_div(spread(fit[SUM_NXY], fit[SUM_NX], fit[SUM_NY], weight), weight) >> 2;
    int32_t yy = floor_div(spread(fit[SUM_NYY], fit[SUM_NY], fit[SUM_NY], weight), weight) >> 2;
    int32_t xe = 2 * floor_div(spread(fit[SUM_NXE], fit[SUM_NX], fit[SUM_E], weight), weight);
    int32_t ye = 2 * floor_div(spread(fit[SUM_NYE], fit[SUM_NY], fit[SUM_E], weight), weight);
    int32_t size = (xx * yy - xy * xy) >> 4;
    int32_t along_x = 0;
    int32_t along_y = 0;
    if (size >= SHORTEST_ARC) {
        along_x = floor_div(xe * yy - ye * xy + (size >> 1), size);
        along_y = floor_div(ye * xx - xe * xy + (size >> 1), size);
        along_x = min(max(along_x, -fit_range), fit_range);
        along_y = min(max(along_y, -fit_range), fit_range);
        fit[CENTRE_X] = fit[CENTRE_X] + along_x;
        fit[CENTRE_Y] = fit[CENTRE_Y] + along_y;
    }
    int32_t towards = ((fit[SUM_NX] >> 1) * along_x + (fit[SUM_NY] >> 1) * along_y) >> (NORMAL_BITS - 1);
    int32_t larger = floor_div(2 * (fit[SUM_E] - towards) + weight, 2 * weight);
    fit[RADIUS] = fit[RADIUS] + larger;
    return max(max(abs(along_x), abs(along_y)), abs(larger));
}

HELPER void take_off_blur(int32_t fit[])
{
    int32_t square = floor_div(fit[SQUARE_SUM], max(floor_div(fit[RISE_SUM], FINE), 1)) - OWN_SQUARE;
    if (square > 0) {
        int32_t radius = max(fit[RADIUS], FINE);
        fit[RADIUS] = fit[RADIUS] + floor_div(FINE * square + radius, 2 * radius);
    }
}

KERNEL void fit_circle(const uint32_t points[], uint16_t weights[], int32_t fit[], int32_t fit_range, int32_t rounds)
{
    weigh(weights, fit);
    int32_t near = FINE * fit_range;
    for (int32_t i = 0; i < rounds; i++) {
        sum_up(points, weights, fit[REFINED], fit, near);
        int32_t moved = move_circle(fit, near);
        int32_t nearer = max(near >> 1, min(max(fit[RADIUS] >> NEAR_BITS, NEAR_POINTS), near));
        if (moved <= STILL && nearer == near)
            break;
        near = nearer;
    }
    take_off_blur(fit);
}
