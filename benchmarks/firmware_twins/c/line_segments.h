#ifndef LINE_SEGMENTS_H
#define LINE_SEGMENTS_H

#include "twin.h"

/* words of a segment */
#define EDGES 0
#define SUM_X 1
#define SUM_Y 2
#define SUM_XX 3
#define SUM_XY 4
#define SUM_YY 5
#define START_X 6
#define START_Y 7
#define END_X 8
#define END_Y 9
#define DIRECTION 10
#define TURN 11
#define LAST_ROW 12
#define SEGMENT_WORDS 13

#define NONE (-1)

/* counters of the scan */
#define FREE 0
#define UNPLACED 1

KERNEL int32_t turn_between(int32_t angle, int32_t reference);
KERNEL int32_t is_flat(int32_t direction);
KERNEL int32_t new_segment(int32_t segments[], int32_t scan[], int32_t x, int32_t y, int32_t direction);
KERNEL void add_edge(int32_t segments[], int32_t place, int32_t x, int32_t y, int32_t direction,
                     int32_t mean_edges);
KERNEL int32_t line_length(const int32_t segments[], int32_t base);
KERNEL void copy_segment(int32_t segments[], int32_t source, int32_t target);

#endif
