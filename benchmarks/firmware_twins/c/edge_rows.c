/* Twin of tinyphoon/stages/edge_rows.py. */
#include "edge_rows.h"

HELPER int32_t is_level(uint32_t edge, int32_t level_range)
{
    /* half a turn is 128: above 0 and below twice the range, counted from as far before straight down */
    return (((int32_t)(edge >> 8) + level_range - 65) & 127) < 2 * level_range - 1 ? 1 : 0;
}

HELPER int32_t take_edges(const uint32_t edges[], int32_t first, int32_t count, uint32_t row[], int32_t level_range)
{
    int32_t taken = 0;
    for (int32_t place = first; place < first + count; place++) {
        uint32_t edge = edges[place];
        if (is_level(edge, level_range) == 0) {
            row[taken] = edge;
            taken = taken + 1;
        }
    }
    return taken;
}

KERNEL int32_t take_left_row(const uint32_t edge_data[], const uint32_t edge_index[], const uint16_t edge_counts[],
                             int32_t y, uint32_t row[], int32_t level_range)
{
    return take_edges(edge_data, (int32_t)edge_index[y], edge_counts[y], row, level_range);
}

KERNEL int32_t take_right_row(const uint32_t right_edges[], const uint32_t right_rows[], int32_t y, uint32_t row[],
                              int32_t level_range)
{
    uint32_t here = right_rows[y];
    return take_edges(right_edges, (int32_t)(here & 0xFFFF), (int32_t)(here >> 16), row, level_range);
}

HELPER void spread_edges(const uint32_t edges[], int32_t first, int32_t count, uint16_t window[], int32_t slot,
                         int32_t level_range, int32_t window_length)
{
    int32_t pitch = window_length / WINDOW_ROWS;
    int32_t base = slot * pitch;
    for (int32_t place = base; place < base + pitch; place++)
        window[place] = 0;
    for (int32_t place = first; place < first + count; place++) {
        uint32_t edge = edges[place];
        if (is_level(edge, level_range) == 0)
            window[base + (int32_t)(edge >> 16)] = edge & 0xFFFF;
    }
}

KERNEL void spread_left_row(const uint32_t edge_data[], const uint32_t edge_index[], const uint16_t edge_counts[],
                            int32_t y, uint16_t window[], int32_t slot, int32_t level_range,
                            int32_t edge_counts_length, int32_t window_length)
{
    int32_t first = 0;
    int32_t count = 0;
    if (0 <= y && y < edge_counts_length) {
        first = (int32_t)edge_index[y];
        count = edge_counts[y];
    }
    spread_edges(edge_data, first, count, window, slot, level_range, window_length);
}

KERNEL void spread_right_row(const uint32_t right_edges[], const uint32_t right_rows[], int32_t y, uint16_t window[],
                             int32_t slot, int32_t level_range, int32_t right_rows_length, int32_t window_length)
{
    uint32_t here = 0;
    if (0 <= y && y < right_rows_length)
        here = right_rows[y];
    spread_edges(right_edges, (int32_t)(here & 0xFFFF), (int32_t)(here >> 16), window, slot, level_range,
                 window_length);
}
