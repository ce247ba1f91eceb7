/* Twin of tinyphoon/stages/edge_correspondence.py. */
#include "edge_rows.h"
#include "geometry.h"
#include "line_segments.h"
#include "lines.h"

#define WORST 0xFFFF

/* half-words of a link */
#define LINK_BEFORE 0
#define LINK_LEFT 1
#define LINK_RIGHT 2
#define LINK_WORDS 3

#define STEP 4

/* half-words of a 3-D edge */
#define EDGE3D_X 0
#define EDGE3D_LEFT 3
#define EDGE3D_WORDS 4

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

HELPER int32_t first_behind(const uint32_t row[], int32_t first, int32_t count, int32_t x)
{
    while (first < count && (int32_t)(row[first] >> 16) <= x)
        first = first + 1;
    return first;
}

HELPER void clear_path(int32_t values[], uint16_t ends[], int32_t right_count)
{
    for (int32_t right = 0; right < right_count; right++) {
        values[right] = 0;
        ends[right] = 0;
    }
}

HELPER int32_t disparity_of(const uint32_t left_row[], int32_t left, const uint32_t right_row[], int32_t right)
{
    return (int32_t)(left_row[left] >> 16) - (int32_t)(right_row[right] >> 16);
}

HELPER int32_t add_pair(const uint32_t left_row[], int32_t left, const uint32_t right_row[], int32_t right,
                        int32_t right_count, int32_t score, int32_t values[], uint16_t ends[], uint16_t links[],
                        int32_t used, int32_t links_length)
{
    int32_t value = WORST - score;
    int32_t before = 0;
    if (right > 0) {
        before = ends[right - 1];
        value = value + values[right - 1];
    }
    if (before != 0) {
        int32_t link = LINK_WORDS * before;
        int32_t last = disparity_of(left_row, links[link + LINK_LEFT], right_row, links[link + LINK_RIGHT]);
        value = value - STEP * abs(disparity_of(left_row, left, right_row, right) - last);
    }
    int32_t link = LINK_WORDS * used;
    if (value <= values[right] || link + LINK_WORDS > links_length)
        return used;
    links[link + LINK_BEFORE] = before;
    links[link + LINK_LEFT] = left;
    links[link + LINK_RIGHT] = right;
    int32_t place = right;
    while (place < right_count && values[place] < value) {
        values[place] = value;
        ends[place] = used;
        place = place + 1;
    }
    return used + 1;
}

HELPER int32_t columns_apart(const uint32_t row[], int32_t one, int32_t other)
{
    return abs((int32_t)(row[one] >> 16) - (int32_t)(row[other] >> 16));
}

HELPER void take_path(const uint32_t left_row[], int32_t left_count, const uint32_t right_row[], uint16_t partners[],
                      const uint16_t bests[], const uint16_t rivals[], const uint16_t owners[], int32_t margin,
                      const uint16_t links[], int32_t end)
{
    int32_t link = LINK_WORDS * end;
    for (int32_t left = left_count - 1; left > -1; left--) {
        int32_t best = partners[left];
        partners[left] = 0;
        if (link != 0 && links[link + LINK_LEFT] == left) {
            int32_t right = links[link + LINK_RIGHT];
            link = LINK_WORDS * links[link + LINK_BEFORE];
            int32_t has_rival = best == 0 || bests[right] + margin > rivals[right];
            if (!has_rival && columns_apart(right_row, best - 1, right) <= 1
                && columns_apart(left_row, owners[right] - 1, left) <= 1)
                partners[left] = right + 1;
        }
    }
}

KERNEL void match_edges(const uint32_t left_row[], int32_t left_count, const uint32_t right_row[],
                        int32_t right_count, const uint16_t left_window[], const uint16_t right_window[],
                        int32_t slot, uint16_t partners[], uint16_t bests[], uint16_t rivals[], uint16_t owners[],
                        int32_t values[], uint16_t ends[], uint16_t links[], int32_t direction_range,
                        int32_t max_disparity, int32_t lack, int32_t margin, int32_t left_window_length,
                        int32_t links_length)
{
    for (int32_t right = 0; right < right_count; right++) {
        bests[right] = WORST;
        rivals[right] = WORST;
        owners[right] = 0;
    }
    clear_path(values, ends, right_count);
    int32_t pitch = left_window_length / WINDOW_ROWS;
    int32_t behind = 0;
    int32_t used = 1;
    for (int32_t left = 0; left < left_count; left++) {
        uint32_t edge = left_row[left];
        int32_t x = (int32_t)(edge >> 16);
        int32_t best = WORST;
        int32_t rival = WORST;
        int32_t best_x = x;
        int32_t partner = 0;
        behind = first_behind(right_row, behind, right_count, x);
        for (int32_t right = behind - 1; right > -1; right--) {
            uint32_t other = right_row[right];
            int32_t other_x = (int32_t)(other >> 16);
            if (x - other_x > max_disparity)
                break;
            int32_t score = unlike((int32_t)(edge & 0xFFFF), (int32_t)(other & 0xFFFF), direction_range);
            if (score < WORST) {
                int32_t around = unlike_around(left_window, right_window, pitch, slot, x, x - other_x,
                                               direction_range, lack);
                score = score + around;
                if (score < best) {
                    if (best_x - other_x > 1)
                        rival = best;
                    best = score;
                    best_x = other_x;
                    partner = around < (WINDOW_ROWS - 1) * lack ? right + 1 : 0;
                } else if (best_x - other_x > 1) {
                    rival = score < rival ? score : rival;
                }
                offer(left_row, left, right, score, bests, rivals, owners);
                used = add_pair(left_row, left, right_row, right, right_count, score, values, ends, links, used,
                                links_length);
            }
        }
        partners[left] = best + margin <= rival ? partner : 0;
    }
    if (right_count > 0) {
        int32_t end = ends[right_count - 1];
        take_path(left_row, left_count, right_row, partners, bests, rivals, owners, margin, links, end);
    }
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
