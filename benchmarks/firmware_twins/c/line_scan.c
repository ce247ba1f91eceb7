/* Twin of tinyphoon/stages/line_scan.py. */
#include "line_segments.h"

HELPER int32_t run_length(const uint32_t edge_data[], int32_t begin, int32_t stop, int32_t angle_range,
                          int32_t mean_edges)
{
    int32_t x = (int32_t)(edge_data[begin] >> 16);
    int32_t direction = (int32_t)(edge_data[begin] >> 8 & 255);
    int32_t turns = 0;
    int32_t averaged = 1;
    int32_t length = 1;
    while (begin + length < stop && (int32_t)(edge_data[begin + length] >> 16) == x + length) {
        int32_t turn = turn_between((int32_t)(edge_data[begin + length] >> 8 & 255), direction);
        if (abs(turn * averaged - turns) > angle_range * averaged)
            break;
        if (averaged < mean_edges) {
            turns = turns + turn;
            averaged = averaged + 1;
        }
        length = length + 1;
    }
    return length;
}

HELPER int32_t run_turn(const uint32_t edge_data[], int32_t begin, int32_t averaged)
{
    int32_t direction = (int32_t)(edge_data[begin] >> 8 & 255);
    int32_t turns = 0;
    for (int32_t edge = begin + 1; edge < begin + averaged; edge++)
        turns = turns + turn_between((int32_t)(edge_data[edge] >> 8 & 255), direction);
    return turns;
}

HELPER int32_t touched_segment(const uint8_t above[], const int32_t segments[], int32_t left, int32_t right,
                               int32_t direction, int32_t turns, int32_t averaged, int32_t angle_range,
                               int32_t mean_edges, int32_t above_length)
{
    int32_t label = 0;
    int32_t stop = min(right + 1, above_length - 1) + 1;
    for (int32_t x = max(left - 1, 0); x < stop; x++) {
        if (above[x] != 0 && above[x] != label) {
            label = above[x];
            int32_t base = (label - 1) * SEGMENT_WORDS;
            int32_t mean_of = min(segments[base + EDGES], mean_edges);
            int32_t turn = turn_between(direction, segments[base + DIRECTION]);
            int32_t apart = (turn * averaged + turns) * mean_of - segments[base + TURN] * averaged;
            if (abs(apart) <= angle_range * averaged * mean_of)
                return label - 1;
        }
    }
    return NONE;
}

HELPER void close_segments(const uint32_t edge_data[], int32_t begin, int32_t stop, uint8_t above[],
                           int32_t segments[], int32_t scan[], int32_t y, int32_t min_length)
{
    for (int32_t edge = begin; edge < stop; edge++) {
        int32_t x = (int32_t)(edge_data[edge] >> 16);
        if (above[x] != 0) {
            int32_t place = above[x] - 1;
            above[x] = 0;
            int32_t base = place * SEGMENT_WORDS;
            int32_t length = line_length(segments, base);
            if (segments[base + LAST_ROW] < y && 0 < length && length < min_length) {
                segments[base + EDGES] = 0;
                segments[base + LAST_ROW] = scan[FREE];
                scan[FREE] = place;
            }
        }
    }
}

KERNEL void segments_row(const uint32_t edge_data[], const uint32_t edge_index[], const uint16_t edge_counts[],
                         int32_t y, uint8_t above[], uint8_t here[], int32_t segments[], int32_t scan[],
                         int32_t angle_range, int32_t mean_edges, int32_t min_length, int32_t above_length)
{
    int32_t begin = (int32_t)edge_index[y];
    int32_t stop = begin + edge_counts[y];
    while (begin < stop) {
        int32_t length = run_length(edge_data, begin, stop, angle_range, mean_edges);
        int32_t left = (int32_t)(edge_data[begin] >> 16);
        int32_t direction = (int32_t)(edge_data[begin] >> 8 & 255);
        int32_t averaged = min(length, mean_edges);
        int32_t turns = run_turn(edge_data, begin, averaged);
        int32_t place = touched_segment(above, segments, left, left + length - 1, direction, turns, averaged,
                                        angle_range, mean_edges, above_length);
        if (place == NONE)
            place = new_segment(segments, scan, left, y, direction);
        if (place == NONE) {
            scan[UNPLACED] = scan[UNPLACED] + length;
        } else {
            for (int32_t edge = begin; edge < begin + length; edge++) {
                int32_t x = (int32_t)(edge_data[edge] >> 16);
                add_edge(segments, place, x, y, (int32_t)(edge_data[edge] >> 8 & 255), mean_edges);
                here[x] = (uint8_t)(place + 1);
            }
        }
        begin = begin + length;
    }
    if (y > 0) {
        begin = (int32_t)edge_index[y - 1];
        close_segments(edge_data, begin, begin + edge_counts[y - 1], above, segments, scan, y, min_length);
    }
}
