/* Twin of tinyphoon/stages/stereo_edges.py. */
#include "geometry.h"
#include "line_segments.h"
#include "lines.h"

#define DISPARITY_BITS 12

/* half-words of a 3-D edge */
#define EDGE3D_X 0
#define EDGE3D_LEFT 3
#define EDGE3D_WORDS 4

HELPER int32_t is_level(uint32_t edge, int32_t level_range)
{
    int32_t from_up = abs(turn_between((int32_t)(edge >> 8 & 255) << 1 & 255, 128));
    return from_up < level_range << 1 ? 1 : 0;
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

KERNEL int32_t take_right_row(const uint32_t right_edges[], const uint32_t right_rows[], int32_t y, uint32_t row[],
                              int32_t level_range)
{
    uint32_t here = right_rows[y];
    return take_edges(right_edges, (int32_t)(here & 0xFFFF), (int32_t)(here >> 16), row, level_range);
}

HELPER int32_t matching_edge(uint32_t edge, const uint32_t others[], int32_t count, int32_t side,
                             int32_t by_likeness, int32_t direction_range, int32_t min_disparity,
                             int32_t max_disparity)
{
    int32_t x = (int32_t)(edge >> 16);
    int32_t best = NONE;
    int32_t least = 1 << 30;
    int32_t last_disparity = side > 0 ? min_disparity : -max_disparity;
    for (int32_t place = 0; place < count; place++) {
        uint32_t other = others[place];
        int32_t apart = x - (int32_t)(other >> 16);
        if (apart < last_disparity)
            break;
        int32_t disparity = side * apart;
        if (min_disparity <= disparity && disparity <= max_disparity) {
            int32_t turn = abs(turn_between((int32_t)(other >> 8 & 255), (int32_t)(edge >> 8 & 255)));
            if (turn <= direction_range) {
                int32_t unlike = 2 * turn + abs((int32_t)(other & 255) - (int32_t)(edge & 255));
                int32_t off = (by_likeness * unlike << DISPARITY_BITS) + disparity;
                if (off < least) {
                    best = place;
                    least = off;
                }
            }
        }
    }
    return best;
}

KERNEL int32_t stereo_edges_row(const uint32_t edge_data[], const uint32_t edge_index[],
                                const uint16_t edge_counts[], int32_t y, uint32_t left_row[],
                                const uint32_t right_row[], int32_t right_count, const int32_t geometry[],
                                int32_t is_mutual, int32_t level_range, int32_t direction_range,
                                int32_t min_disparity, int32_t max_disparity, int32_t width, int32_t height,
                                int16_t edges_3d[], int32_t found, int32_t edges_3d_length)
{
    int32_t place = (int32_t)edge_index[y];
    int32_t left_count = take_edges(edge_data, place, edge_counts[y], left_row, level_range);
    for (int32_t left = 0; left < left_count; left++) {
        uint32_t edge = left_row[left];
        int32_t right = matching_edge(edge, right_row, right_count, 1, is_mutual, direction_range, min_disparity,
                                      max_disparity);
        if (right != NONE && is_mutual != 0) {
            int32_t back = matching_edge(right_row[right], left_row, left_count, -1, is_mutual, direction_range,
                                         min_disparity, max_disparity);
            if (back != left)
                right = NONE;
        }
        if (right != NONE) {
            int32_t x = (int32_t)(edge >> 16);
            int32_t disparity = SUBPIXELS * (x - (int32_t)(right_row[right] >> 16));
            int32_t base = EDGE3D_WORDS * found;
            int32_t stored = 1;
            if (base < edges_3d_length)
                stored = store_point(geometry, SUBPIXELS * x, SUBPIXELS * y, disparity, width, height, edges_3d,
                                     base + EDGE3D_X);
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
