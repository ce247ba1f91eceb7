/* Twin of tinyphoon/stages/hysteresis.py. */
#include "twin.h"

KERNEL void clear_labels(uint16_t labels[], int32_t labels_length)
{
    for (int32_t x = 0; x < labels_length; x++)
        labels[x] = 0;
}

HELPER int32_t known_label(const uint16_t above[], const uint16_t here[], int32_t x)
{
    if (above[x] != 0)
        return above[x];
    if (here[x - 1] != 0)
        return here[x - 1];
    if (above[x - 1] != 0)
        return above[x - 1];
    return above[x + 1];
}

HELPER int32_t new_label(int32_t given, int32_t last)
{
    return min(given + 1, last);
}

HELPER int32_t group_of(uint16_t groups[], int32_t label)
{
    int32_t group = label;
    while (groups[group] != group)
        group = groups[group];
    while (groups[label] != group) {
        int32_t onward = groups[label];
        groups[label] = (uint16_t)group;
        label = onward;
    }
    return group;
}

HELPER void join_groups(uint16_t groups[], uint8_t strongest[], int32_t one, int32_t other)
{
    one = group_of(groups, one);
    other = group_of(groups, other);
    int32_t low = min(one, other);
    int32_t high = max(one, other);
    groups[high] = (uint16_t)low;
    strongest[low] = (uint8_t)max(strongest[low], strongest[high]);
}

KERNEL int32_t group_edges_row(const uint32_t edge_data[], const uint32_t edge_index[], const uint16_t edge_counts[],
                               int32_t y, const uint16_t above[], uint16_t here[], uint16_t groups[],
                               uint8_t strongest[], int32_t given, int32_t here_length, int32_t groups_length)
{
    clear_labels(here, here_length);
    int32_t last = groups_length - 1;
    int32_t first = (int32_t)edge_index[y];
    int32_t stop = first + edge_counts[y];
    for (int32_t position = first; position < stop; position++) {
        uint32_t edge = edge_data[position];
        int32_t x = (int32_t)(edge >> 16);
        int32_t label = known_label(above, here, x);
        if (label == 0) {
            label = new_label(given, last);
            given = given + 1;
            if (given <= last) {
                groups[label] = (uint16_t)label;
                strongest[label] = 0;
            }
        } else if (above[x] == 0 && above[x + 1] != 0) {
            join_groups(groups, strongest, label, above[x + 1]);
        }
        here[x] = (uint16_t)label;
        int32_t group = group_of(groups, label);
        strongest[group] = (uint8_t)max(strongest[group], (int32_t)(edge & 255));
    }
    return given;
}

KERNEL void hold_groups(const uint16_t labels[], uint16_t groups[], uint8_t strongest[], int32_t labels_length)
{
    for (int32_t x = 0; x < labels_length; x++) {
        if (labels[x] != 0)
            strongest[group_of(groups, labels[x])] = 255;
    }
}

KERNEL int32_t label_edges_row(const uint32_t edge_data[], const uint32_t edge_index[], const uint16_t edge_counts[],
                               int32_t y, const uint16_t above[], uint16_t here[], int32_t last, int32_t given,
                               int32_t here_length)
{
    clear_labels(here, here_length);
    int32_t first = (int32_t)edge_index[y];
    int32_t stop = first + edge_counts[y];
    for (int32_t position = first; position < stop; position++) {
        int32_t x = (int32_t)(edge_data[position] >> 16);
        int32_t label = known_label(above, here, x);
        if (label == 0) {
            label = new_label(given, last);
            given = given + 1;
        }
        here[x] = (uint16_t)label;
    }
    return given;
}

KERNEL int32_t keep_edges_row(const uint16_t labels[], uint16_t groups[], const uint8_t strongest[],
                              int32_t strong_threshold, uint8_t edges[], uint32_t edge_data[],
                              uint32_t edge_index[], uint16_t edge_counts[], int32_t y, int32_t kept,
                              int32_t edges_length)
{
    for (int32_t x = 0; x < edges_length; x++)
        edges[x] = 0;
    int32_t first = (int32_t)edge_index[y];
    edge_index[y] = (uint32_t)kept;
    int32_t stop = first + edge_counts[y];
    for (int32_t position = first; position < stop; position++) {
        uint32_t edge = edge_data[position];
        int32_t x = (int32_t)(edge >> 16);
        if (strongest[group_of(groups, labels[x])] >= strong_threshold) {
            edge_data[kept] = edge;
            edges[x] = (uint8_t)(edge & 255);
            kept = kept + 1;
        }
    }
    edge_counts[y] = (uint16_t)(kept - (int32_t)edge_index[y]);
    return kept;
}
