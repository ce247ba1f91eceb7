/* Twin of tinyphoon/stages/line_segments.py, as far as other twins call it. */
#include "line_segments.h"

KERNEL int32_t turn_between(int32_t angle, int32_t reference)
{
    return ((angle - reference + 128) & 255) - 128;
}

KERNEL int32_t is_flat(int32_t direction)
{
    return (direction + 32) >> 6 & 1;
}

KERNEL int32_t new_segment(int32_t segments[], int32_t scan[], int32_t x, int32_t y, int32_t direction)
{
    int32_t place = scan[FREE];
    if (place == NONE)
        return NONE;
    int32_t base = place * SEGMENT_WORDS;
    scan[FREE] = segments[base + LAST_ROW];
    for (int32_t word = 0; word < SEGMENT_WORDS; word++)
        segments[base + word] = 0;
    segments[base + START_X] = x;
    segments[base + START_Y] = y;
    segments[base + END_X] = x;
    segments[base + END_Y] = y;
    segments[base + DIRECTION] = direction;
    return place;
}

KERNEL void add_edge(int32_t segments[], int32_t place, int32_t x, int32_t y, int32_t direction, int32_t mean_edges)
{
    int32_t base = place * SEGMENT_WORDS;
    if (segments[base + EDGES] < mean_edges) {
        int32_t turn = turn_between(direction, segments[base + DIRECTION]);
        segments[base + TURN] = segments[base + TURN] + turn;
    }
    segments[base + EDGES] = segments[base + EDGES] + 1;
    segments[base + SUM_X] = segments[base + SUM_X] + x;
    segments[base + SUM_Y] = segments[base + SUM_Y] + y;
    segments[base + SUM_XX] = segments[base + SUM_XX] + x * x;
    segments[base + SUM_XY] = segments[base + SUM_XY] + x * y;
    segments[base + SUM_YY] = segments[base + SUM_YY] + y * y;
    segments[base + LAST_ROW] = y;
    int32_t flat = is_flat(segments[base + DIRECTION]);
    if (flat != 0 && x < segments[base + START_X]) {
        segments[base + START_X] = x;
        segments[base + START_Y] = y;
    } else if (flat == 0 || x > segments[base + END_X]) {
        segments[base + END_X] = x;
        segments[base + END_Y] = y;
    }
}

KERNEL int32_t line_length(const int32_t segments[], int32_t base)
{
    int32_t dx = segments[base + END_X] - segments[base + START_X];
    int32_t dy = segments[base + END_Y] - segments[base + START_Y];
    return min(segments[base + EDGES], max(abs(dx), abs(dy)) + 1);
}

KERNEL void copy_segment(int32_t segments[], int32_t source, int32_t target)
{
    for (int32_t word = 0; word < SEGMENT_WORDS; word++)
        segments[target * SEGMENT_WORDS + word] = segments[source * SEGMENT_WORDS + word];
}
