#ifndef BLOBS_H
#define BLOBS_H

#include "twin.h"

#define BLOB_WORDS 8
#define COLOURS 0
#define PIXELS 1
#define SUM_X 2
#define SUM_Y 3
#define ACROSS 4
#define DOWN 5

KERNEL uint32_t wider(uint32_t span, int32_t first, int32_t last);
KERNEL void open_segment(uint32_t blob_data[], int32_t label, uint32_t colours, int32_t x, int32_t y);
KERNEL void add_run(uint32_t blob_data[], int32_t label, int32_t first, int32_t last, int32_t y);

#endif
