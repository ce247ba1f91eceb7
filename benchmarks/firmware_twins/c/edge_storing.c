/* Twin of tinyphoon/stages/edge_storing.py. */
#include "twin.h"

KERNEL int32_t store_edges_row(const uint8_t gradient[], const uint8_t direction[], uint32_t edge_data[],
                               uint32_t edge_index[], uint16_t edge_counts[], int32_t y, int32_t found,
                               int32_t gradient_length, int32_t edge_data_length)
{
    int32_t first = min(found, edge_data_length);
    for (int32_t x = 0; x < gradient_length; x++) {
        if (gradient[x] != 0) {
            if (found < edge_data_length)
                edge_data[found] = (uint32_t)(gradient[x] | direction[x] << 8 | x << 16);
            found = found + 1;
        }
    }
    edge_index[y] = (uint32_t)first;
    edge_counts[y] = (uint16_t)(min(found, edge_data_length) - first);
    return found;
}
