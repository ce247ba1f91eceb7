/* Twin of tinyphoon/stages/edge_detection.py. */
#include "arithmetic.h"

KERNEL void grey_row(const uint8_t uyvy[], uint8_t grey[], int32_t grey_length)
{
    for (int32_t x = 0; x < grey_length; x++)
        grey[x] = uyvy[2 * x + 1];
}

KERNEL void gauss3_row(const uint8_t above[], const uint8_t here[], const uint8_t below[], uint8_t smooth[],
                       int32_t here_length)
{
    int32_t last = here_length - 1;
    smooth[0] = here[0];
    for (int32_t x = 1; x < last; x++) {
        int32_t top = above[x - 1] + 2 * above[x] + above[x + 1];
        int32_t middle = here[x - 1] + 2 * here[x] + here[x + 1];
        int32_t bottom = below[x - 1] + 2 * below[x] + below[x + 1];
        smooth[x] = (uint8_t)((top + 2 * middle + bottom) >> 4);
    }
    smooth[last] = here[last];
}

KERNEL void sobel_row(const uint8_t above[], const uint8_t here[], const uint8_t below[], int16_t gx[],
                      int16_t gy[], int32_t here_length)
{
    int32_t last = here_length - 1;
    gx[0] = 0;
    gy[0] = 0;
    for (int32_t x = 1; x < last; x++) {
        int32_t left = above[x - 1] + 2 * here[x - 1] + below[x - 1];
        int32_t right = above[x + 1] + 2 * here[x + 1] + below[x + 1];
        int32_t top = above[x - 1] + 2 * above[x] + above[x + 1];
        int32_t bottom = below[x - 1] + 2 * below[x] + below[x + 1];
        gx[x] = (int16_t)(right - left);
        gy[x] = (int16_t)(bottom - top);
    }
    gx[last] = 0;
    gy[last] = 0;
}

KERNEL void magnitude_row(const int16_t gx[], const int16_t gy[], uint8_t magnitude[], int32_t magnitude_length)
{
    for (int32_t x = 0; x < magnitude_length; x++) {
        int32_t square = gx[x] * gx[x] + gy[x] * gy[x];
        magnitude[x] = (uint8_t)min((int32_t)isqrt32((uint32_t)square) >> 2, 255);
    }
}

KERNEL void direction_row(const int16_t gx[], const int16_t gy[], const uint8_t atan[], uint8_t direction[],
                          int32_t direction_length)
{
    for (int32_t x = 0; x < direction_length; x++)
        direction[x] = (uint8_t)angle8(gx[x], gy[x], atan);
}

KERNEL void suppress_row(const uint8_t above[], const uint8_t here[], const uint8_t below[],
                         const uint8_t direction[], uint8_t edges[], int32_t edge_threshold,
                         int32_t here_length)
{
    int32_t last = here_length - 1;
    edges[0] = 0;
    for (int32_t x = 1; x < last; x++) {
        int32_t octant = ((direction[x] + 16) >> 5) & 3;
        int32_t before, after;
        if (octant == 0) {
            before = here[x - 1];
            after = here[x + 1];
        } else if (octant == 1) {
            before = above[x - 1];
            after = below[x + 1];
        } else if (octant == 2) {
            before = above[x];
            after = below[x];
        } else {
            before = above[x + 1];
            after = below[x - 1];
        }
        if (here[x] >= edge_threshold && here[x] >= before && here[x] > after)
            edges[x] = here[x];
        else
            edges[x] = 0;
    }
    edges[last] = 0;
}
