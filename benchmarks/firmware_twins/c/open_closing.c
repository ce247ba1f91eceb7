/* Twin of tinyphoon/stages/open_closing.py. */
#include "twin.h"

KERNEL void erode_row(const uint32_t above[], const uint32_t here[], const uint32_t below[], uint32_t eroded[],
                      int32_t here_length)
{
    int32_t last = here_length - 1;
    eroded[0] = 0;
    for (int32_t x = 1; x < last; x++) {
        uint32_t top = above[x - 1] & above[x] & above[x + 1];
        uint32_t middle = here[x - 1] & here[x] & here[x + 1];
        uint32_t bottom = below[x - 1] & below[x] & below[x + 1];
        eroded[x] = top & middle & bottom;
    }
    eroded[last] = 0;
}

KERNEL void dilate_row(const uint32_t above[], const uint32_t here[], const uint32_t below[], uint32_t dilated[],
                       int32_t here_length)
{
    int32_t last = here_length - 1;
    dilated[0] = 0;
    for (int32_t x = 1; x < last; x++) {
        uint32_t top = above[x - 1] | above[x] | above[x + 1];
        uint32_t middle = here[x - 1] | here[x] | here[x + 1];
        uint32_t bottom = below[x - 1] | below[x] | below[x + 1];
        dilated[x] = top | middle | bottom;
    }
    dilated[last] = 0;
}
