/* Twin of tinyphoon/stages/edge_correspondence.py. */
#include "geometry.h"
#include "line_segments.h"
#include "lines.h"

#define REACH 2
#define WINDOW_ROWS (2 * REACH + 1)
#define WORST 0xFFFF

/* half-words of a 3-D edge */
#define EDGE3D_X 0
#define EDGE3D_LEFT 3
#define EDGE3D_WORDS 4

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

HELPER int32_t unlike(int32_t edge, int32_t other, int32_t direction_range)
{
    int32_t turn = abs(turn_between(other >> 8 & 255, edge >> 8 & 255));
    if (turn > direction_range)
        return WORST;
    return 2 * turn + abs((other & 255) - (edge & 255));
}

HELPER int32_t unlike_around(const uint16_t left_window[], const uint16_t right_window[], int32_t pitch,
                             int32_t slot, int32_t x, int32_t disparity, int32_t direction_range, int32_t lack)
{
    int32_t total = 0;
    for (int32_t step = 0; step < WINDOW_ROWS; step++) {
        int32_t away = abs(step - REACH);
        if (away != 0) {
            int32_t row = slot + step - REACH;
            if (row < 0)
                row = row + WINDOW_ROWS;
            if (row >= WINDOW_ROWS)
                row = row - WINDOW_ROWS;
            int32_t base = row * pitch;
            int32_t least = lack;
            int32_t first = x - away > disparity ? x - away : disparity;
            int32_t last = x + away < pitch - 1 ? x + away : pitch - 1;
            for (int32_t column = first; column < last + 1; column++) {
                int32_t edge = left_window[base + column];
                if (edge != 0) {
                    int32_t other = right_window[base + column - disparity];
                    if (other != 0) {
                        int32_t score = unlike(edge, other, direction_range);
                        if (score < least)
                            least = score;
                    }
                }
            }
            total = total + least;
        }
    }
    return total;
}

HELPER void offer(const uint32_t left_row[], int32_t left, int32_t right, int32_t score, uint16_t bests[],
                  uint16_t rivals[], uint16_t owners[])
{
    int32_t owner = owners[right];
    int32_t is_apart = 1;
    if (owner != 0 && (int32_t)(left_row[left] >> 16) - (int32_t)(left_row[owner - 1] >> 16) <= 1)
        is_apart = 0;
    if (score < bests[right]) {
        if (is_apart != 0)
            rivals[right] = bests[right];
        bests[right] = score;
        owners[right] = left + 1;
    } else if (is_apart != 0) {
        rivals[right] = score < rivals[right] ? score : rivals[right];
    }
}

HELPER void drop_contested(int32_t left_count, uint16_t partners[], const uint16_t bests[], const uint16_t rivals[],
                           const uint16_t owners[], int32_t margin)
{
    for (int32_t left = 0; left < left_count; left++) {
        int32_t right = partners[left] - 1;
        if (right >= 0 && (owners[right] != left + 1 || bests[right] + margin > rivals[right]))
            partners[left] = 0;
    }
}

KERNEL void match_edges(const uint32_t left_row[], int32_t left_count, const uint32_t right_row[],
                        int32_t right_count, const uint16_t left_window[], const uint16_t right_window[],
                        int32_t slot, uint16_t partners[], uint16_t bests[], uint16_t rivals[], uint16_t owners[],
                        int32_t direction_range, int32_t max_disparity, int32_t lack, int32_t margin,
                        int32_t left_window_length)
{
    for (int32_t right = 0; right < right_count; right++) {
        bests[right] = WORST;
        rivals[right] = WORST;
        owners[right] = 0;
    }
    int32_t pitch = left_window_length / WINDOW_ROWS;
    for (int32_t left = 0; left < left_count; left++) {
        uint32_t edge = left_row[left];
        int32_t x = (int32_t)(edge >> 16);
        int32_t best = WORST;
        int32_t rival = WORST;
        int32_t best_x = NONE;
        int32_t partner = 0;
        for (int32_t right = 0; right < right_count; right++) {
            uint32_t other = right_row[right];
            int32_t other_x = (int32_t)(other >> 16);
            if (other_x > x)
                break;
            int32_t score = WORST;
            if (x - other_x <= max_disparity)
                score = unlike((int32_t)(edge & 0xFFFF), (int32_t)(other & 0xFFFF), direction_range);
            if (score < WORST) {
                int32_t around = unlike_around(left_window, right_window, pitch, slot, x, x - other_x,
                                               direction_range, lack);
                score = score + around;
                if (score < best) {
                    if (other_x - best_x > 1)
                        rival = best;
                    best = score;
                    best_x = other_x;
                    partner = around < (WINDOW_ROWS - 1) * lack ? right + 1 : 0;
                } else if (other_x - best_x > 1) {
                    rival = score < rival ? score : rival;
                }
                offer(left_row, left, right, score, bests, rivals, owners);
            }
        }
        partners[left] = best + margin <= rival ? partner : 0;
    }
    drop_contested(left_count, partners, bests, rivals, owners, margin);
}

KERNEL int32_t store_edges3d_row(const uint32_t edge_data[], const uint32_t edge_index[], int32_t y,
                                 const uint32_t left_row[], int32_t left_count, const uint16_t disparities[],
                                 int32_t min_disparity, const int32_t geometry[], int32_t width, int32_t height,
                                 int16_t edges_3d[], int32_t found, int32_t edges_3d_length)
{
    int32_t place = (int32_t)edge_index[y];
    for (int32_t left = 0; left < left_count; left++) {
        uint32_t edge = left_row[left];
        int32_t x = (int32_t)(edge >> 16);
        int32_t disparity = disparities[x] - 1;
        if (disparity >= min_disparity) {
            int32_t base = EDGE3D_WORDS * found;
            int32_t stored = 1;
            if (base < edges_3d_length)
                stored = store_point(geometry, SUBPIXELS * x, SUBPIXELS * y, SUBPIXELS * disparity, width, height,
                                     edges_3d, base + EDGE3D_X);
            if (stored != 0 && base < edges_3d_length) {
                while (edge_data[place] != edge)
                    place = place + 1;
                edges_3d[base + EDGE3D_LEFT] = (int16_t)place;
            }
            found = found + stored;
        }
    }
    return found;
}
