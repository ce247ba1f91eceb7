/* Twin of tinyphoon/stages/blob_detection.py: `segment_row`. */
#include "blobs.h"

HELPER uint32_t group_of(uint32_t word, const uint32_t colour_groups[])
{
    int32_t number = 0;
    while ((word & colour_groups[number]) == 0)
        number = number + 1;
    return colour_groups[number];
}

HELPER int32_t root_of(int32_t label, uint8_t parents[])
{
    while (parents[label] != label) {
        parents[label] = parents[parents[label]];
        label = parents[label];
    }
    return label;
}

HELPER int32_t joined(int32_t label, int32_t above, uint32_t colours, uint8_t parents[], const uint32_t blob_data[])
{
    if (above == 0 || blob_data[above * BLOB_WORDS + COLOURS] != colours)
        return label;
    int32_t other = root_of(above, parents);
    if (label == 0)
        return other;
    int32_t root = min(label, other);
    parents[max(label, other)] = (uint8_t)root;
    return root;
}

HELPER int32_t after_alike(const uint32_t words[], const uint8_t labels[], int32_t x, uint32_t colours, int32_t above,
                           int32_t words_length)
{
    while (x < words_length && labels[x] == above && (words[x] & colours) != 0)
        x = x + 1;
    return x;
}

HELPER int32_t begin_segment(int32_t label, uint8_t parents[], uint32_t blob_data[], uint32_t colours, int32_t x,
                             int32_t y, int32_t parents_length)
{
    if (label >= parents_length)
        return 0;
    parents[label] = (uint8_t)label;
    open_segment(blob_data, label, colours, x, y);
    return label;
}

KERNEL int32_t segment_row(const uint32_t words[], uint8_t labels[], uint8_t parents[], uint32_t blob_data[],
                           const uint32_t colour_groups[], uint32_t interest, int32_t y, int32_t used,
                           int32_t words_length, int32_t parents_length)
{
    int32_t width = words_length;
    int32_t wanted = used;
    int32_t corner = 0;
    int32_t x = 0;
    while (x < width) {
        while (x < width && (words[x] & interest) == 0) {
            corner = labels[x];
            labels[x] = 0;
            x = x + 1;
        }
        if (x < width) {
            int32_t first = x;
            uint32_t colours = group_of(words[x], colour_groups);
            int32_t label = joined(0, corner, colours, parents, blob_data);
            while (x < width && (words[x] & colours) != 0) {
                if (labels[x] != corner) {
                    corner = labels[x];
                    label = joined(label, corner, colours, parents, blob_data);
                }
                x = after_alike(words, labels, x + 1, colours, corner, words_length);
            }
            if (x < width)
                label = joined(label, labels[x], colours, parents, blob_data);
            if (label == 0) {
                wanted = wanted + 1;
                label = begin_segment(wanted, parents, blob_data, colours, first, y, parents_length);
            }
            for (int32_t at = first; at < x; at++)
                labels[at] = (uint8_t)label;
            if (label != 0)
                add_run(blob_data, label, first, x - 1, y);
        }
    }
    return wanted;
}
