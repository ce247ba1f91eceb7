/* Twin of tinyphoon/stages/edge_correspondence.py. */
#include "edge_rows.h"
#include "line_segments.h"

#define WORST 0xFFFF

/* half-words of a link */
#define LINK_BEFORE 0
#define LINK_LEFT 1
#define LINK_RIGHT 2
#define LINK_WORDS 3

#define STEP 4

#define UNSEEN (WORST / 4)

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
    for (int32_t right = 0; right < right_count + 1; right++) {
        values[right] = 0;
        ends[right] = 0;
    }
}

HELPER int32_t disparity_of(const uint32_t left_row[], int32_t left, const uint32_t right_row[], int32_t right)
{
    return (int32_t)(left_row[left] >> 16) - (int32_t)(right_row[right] >> 16);
}

HELPER int32_t add_pair(const uint32_t left_row[], int32_t left, const uint32_t right_row[], int32_t right,
                        int32_t right_count, int32_t score, int32_t unseen_left, int32_t unseen_right,
                        int32_t values[], uint16_t ends[], uint16_t links[], int32_t used, int32_t links_length)
{
    int32_t gain = WORST - score;
    int32_t value = gain + UNSEEN * unseen_left;
    int32_t before = 0;
    if (right > 0 && ends[right - 1] != 0) {
        int32_t last = LINK_WORDS * ends[right - 1];
        int32_t step = disparity_of(left_row, left, right_row, right)
                       - disparity_of(left_row, links[last + LINK_LEFT], right_row, links[last + LINK_RIGHT]);
        int32_t onward = gain + values[right - 1] - STEP * abs(step);
        if (onward > value) {
            value = onward;
            before = ends[right - 1];
        }
    }
    int32_t whole = value + UNSEEN * unseen_right;
    int32_t link = LINK_WORDS * used;
    if ((value <= values[right] && whole <= values[right_count]) || link + LINK_WORDS > links_length)
        return used;
    links[link + LINK_BEFORE] = before;
    links[link + LINK_LEFT] = left;
    links[link + LINK_RIGHT] = right;
    if (whole > values[right_count]) {
        values[right_count] = whole;
        ends[right_count] = used;
    }
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

HELPER void take_path(const uint32_t left_row[], int32_t left_count, const uint32_t right_row[], int16_t partners[],
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
            partners[left] = -(right + 1);
            int32_t has_rival = best == 0 || bests[right] + margin > rivals[right];
            if (!has_rival && columns_apart(right_row, best - 1, right) <= 1
                && columns_apart(left_row, owners[right] - 1, left) <= 1)
                partners[left] = right + 1;
        }
    }
}

KERNEL void match_edges(const uint32_t left_row[], int32_t left_count, const uint32_t right_row[],
                        int32_t right_count, const uint16_t left_window[], const uint16_t right_window[],
                        int32_t slot, int16_t partners[], uint16_t bests[], uint16_t rivals[], uint16_t owners[],
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
        int32_t seen_left = 0;
        int32_t seen_right = right_count;
        for (int32_t right = behind - 1; right > -1; right--) {
            uint32_t other = right_row[right];
            int32_t other_x = (int32_t)(other >> 16);
            int32_t disparity = x - other_x;
            if (disparity > max_disparity)
                break;
            int32_t score = unlike((int32_t)(edge & 0xFFFF), (int32_t)(other & 0xFFFF), direction_range);
            if (score < WORST) {
                int32_t around = unlike_around(left_window, right_window, pitch, slot, x, disparity,
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
                seen_left = first_behind(left_row, seen_left, left, disparity - 1);
                while ((int32_t)(right_row[seen_right - 1] >> 16) + disparity >= pitch)
                    seen_right = seen_right - 1;
                used = add_pair(left_row, left, right_row, right, right_count, score, seen_left,
                                right_count - seen_right, values, ends, links, used, links_length);
            }
        }
        partners[left] = best + margin <= rival ? partner : 0;
    }
    int32_t end = ends[right_count];
    take_path(left_row, left_count, right_row, partners, bests, rivals, owners, margin, links, end);
}
