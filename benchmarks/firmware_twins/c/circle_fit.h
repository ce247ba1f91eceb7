#ifndef CIRCLE_FIT_H
#define CIRCLE_FIT_H

#include "twin.h"

/* words of a fit */
#define CENTRE_X 0
#define CENTRE_Y 1
#define RADIUS 2
#define WEIGHT 3
#define SUM_NX 4
#define SUM_NY 5
#define SUM_NXX 6
#define SUM_NXY 7
#define SUM_NYY 8
#define SUM_E 9
#define SUM_NXE 10
#define SUM_NYE 11
#define NEXT_EDGE 12
#define REFINED 13
#define BULGE_COSINE 14
#define BULGE_SINE 15
#define RISE_SUM 16
#define SQUARE_SUM 17

KERNEL int32_t near_of(int32_t radius);
KERNEL int32_t distance(int32_t x, int32_t y, const int32_t fit[]);

#endif
