/* Twin of tinyphoon/stores/blobs.py, as far as `segment_row` needs it. */
#include "blobs.h"

HELPER uint32_t pair(int32_t low, int32_t high)
{
    return (uint32_t)(low | high << 16);
}

KERNEL uint32_t wider(uint32_t span, int32_t first, int32_t last)
{
    return pair(min((int32_t)(span & 0xFFFF), first), max((int32_t)(span >> 16), last));
}

KERNEL void open_segment(uint32_t blob_data[], int32_t label, uint32_t colours, int32_t x, int32_t y)
{
    int32_t at = label * BLOB_WORDS;
    blob_data[at + COLOURS] = colours;
    blob_data[at + PIXELS] = 0;
    blob_data[at + SUM_X] = 0;
    blob_data[at + SUM_Y] = 0;
    blob_data[at + ACROSS] = pair(x, x);
    blob_data[at + DOWN] = pair(y, y);
}

KERNEL void add_run(uint32_t blob_data[], int32_t label, int32_t first, int32_t last, int32_t y)
{
    int32_t at = label * BLOB_WORDS;
    int32_t pixels = last + 1 - first;
    blob_data[at + PIXELS] = blob_data[at + PIXELS] + (uint32_t)pixels;
    blob_data[at + SUM_X] = blob_data[at + SUM_X] + (uint32_t)((first + last) * pixels >> 1);
    blob_data[at + SUM_Y] = blob_data[at + SUM_Y] + (uint32_t)(y * pixels);
    blob_data[at + ACROSS] = wider(blob_data[at + ACROSS], first, last);
    blob_data[at + DOWN] = wider(blob_data[at + DOWN], y, y);
}
