/* Twin of tinyphoon/stages/line_connectors.py. */
#include "line_fit.h"
#include "line_segments.h"
#include "lines.h"

HELPER int32_t gap_between(const int32_t segments[], int32_t first, int32_t second)
{
    int32_t dx = segments[second * SEGMENT_WORDS + START_X] - segments[first * SEGMENT_WORDS + END_X];
    int32_t dy = segments[second * SEGMENT_WORDS + START_Y] - segments[first * SEGMENT_WORDS + END_Y];
    return max(abs(dx), abs(dy));
}

HELPER int32_t is_ahead(const int32_t segments[], int32_t first, int32_t second)
{
    int32_t a = first * SEGMENT_WORDS;
    int32_t b = second * SEGMENT_WORDS;
    int32_t along_x = (segments[a + END_X] - segments[a + START_X]) * (segments[b + END_X] - segments[a + END_X]);
    int32_t along_y = (segments[a + END_Y] - segments[a + START_Y]) * (segments[b + END_Y] - segments[a + END_Y]);
    return along_x + along_y > 0 ? 1 : 0;
}

HELPER void join_segments(int32_t segments[], int32_t first, int32_t second)
{
    int32_t a = first * SEGMENT_WORDS;
    int32_t b = second * SEGMENT_WORDS;
    if (segments[b + EDGES] > segments[a + EDGES])
        segments[a + DIRECTION] = segments[b + DIRECTION];
    segments[a + EDGES] = segments[a + EDGES] + segments[b + EDGES];
    segments[a + SUM_X] = segments[a + SUM_X] + segments[b + SUM_X];
    segments[a + SUM_Y] = segments[a + SUM_Y] + segments[b + SUM_Y];
    segments[a + SUM_XX] = segments[a + SUM_XX] + segments[b + SUM_XX];
    segments[a + SUM_XY] = segments[a + SUM_XY] + segments[b + SUM_XY];
    segments[a + SUM_YY] = segments[a + SUM_YY] + segments[b + SUM_YY];
    segments[a + END_X] = segments[b + END_X];
    segments[a + END_Y] = segments[b + END_Y];
}

KERNEL int32_t connect_near(int32_t segments[], int32_t count, int32_t near_gap, int32_t angle_range)
{
    int32_t first = 0;
    while (first < count) {
        int32_t best = NONE;
        int32_t best_gap = near_gap;
        int32_t direction = segments[first * SEGMENT_WORDS + DIRECTION];
        for (int32_t second = 0; second < count; second++) {
            if (second != first) {
                int32_t gap = gap_between(segments, first, second);
                int32_t turn = turn_between(segments[second * SEGMENT_WORDS + DIRECTION], direction);
                if (gap <= best_gap && abs(turn) <= angle_range && is_ahead(segments, first, second) != 0) {
                    best = second;
                    best_gap = gap - 1;
                }
            }
        }
        if (best == NONE) {
            first = first + 1;
        } else {
            join_segments(segments, first, best);
            count = count - 1;
            copy_segment(segments, count, best);
            if (first == count)
                first = best;
        }
    }
    return count;
}

HELPER int32_t around(int32_t position, int32_t other, int32_t perimeter)
{
    int32_t apart = abs(position - other);
    return min(apart, perimeter - apart);
}

KERNEL int32_t connect_far(int32_t segments[], int16_t lines[], int32_t count, const uint8_t atan[], int32_t width,
                           int32_t height, int32_t far_gap, int32_t muff_range)
{
    int32_t perimeter = 2 * (width + height - 2);
    int32_t first = 0;
    while (first < count) {
        int32_t best = NONE;
        int32_t best_gap = far_gap;
        int32_t behind = lines[first * LINE_WORDS + LINE_BEHIND];
        int32_t ahead = lines[first * LINE_WORDS + LINE_AHEAD];
        for (int32_t second = 0; second < count; second++) {
            if (second != first) {
                int32_t off = max(around(behind, lines[second * LINE_WORDS + LINE_BEHIND], perimeter),
                                  around(ahead, lines[second * LINE_WORDS + LINE_AHEAD], perimeter));
                if (off <= muff_range && is_ahead(segments, first, second) != 0) {
                    int32_t gap = gap_between(segments, first, second);
                    if (gap <= best_gap) {
                        best = second;
                        best_gap = gap - 1;
                    }
                }
            }
        }
        if (best == NONE) {
            first = first + 1;
        } else {
            join_segments(segments, first, best);
            fit_line(segments, first, lines, first, atan, width, height);
            count = count - 1;
            if (best != count) {
                copy_segment(segments, count, best);
                for (int32_t word = 0; word < LINE_WORDS; word++)
                    lines[best * LINE_WORDS + word] = lines[count * LINE_WORDS + word];
            }
            if (first == count)
                first = best;
        }
    }
    return count;
}
