/* Twin of tinyphoon/stages/colour_reduction.py. */
#include "arithmetic.h"

#define BLACK_NUMBER 1
#define WHITE_NUMBER 2
#define FIRST_HUE 3
#define HUES 28
#define MOST_CHROMA 181
#define DARKEST -MOST_CHROMA

HELPER uint32_t colour_word(int32_t brightness, uint32_t hue, int32_t eps_black, int32_t eps_white,
                            const uint32_t joined_colours[])
{
    if (brightness < eps_black)
        return joined_colours[BLACK_NUMBER];
    if (brightness > eps_white)
        return joined_colours[WHITE_NUMBER];
    return hue;
}

KERNEL void colour_row(const uint8_t uyvy[], const uint8_t atan[], const uint32_t joined_colours[],
                       uint32_t colours[], int32_t eps_black, int32_t eps_white, int32_t least_chroma,
                       int32_t colours_length)
{
    int32_t never_black = least_chroma != 0 ? least_chroma : MOST_CHROMA + 1;
    for (int32_t pair = 0; pair < colours_length >> 1; pair++) {
        int32_t u = uyvy[4 * pair] - 128;
        int32_t v = uyvy[4 * pair + 2] - 128;
        int32_t chroma = (int32_t)isqrt32((uint32_t)(v * v + u * u));
        int32_t left = uyvy[4 * pair + 1] - chroma;
        int32_t right = uyvy[4 * pair + 3] - chroma;
        int32_t darkest = chroma < never_black ? eps_black : DARKEST;
        uint32_t hue = 0;
        if (chroma >= least_chroma && max(left, right) >= darkest && min(left, right) <= eps_white)
            hue = joined_colours[FIRST_HUE + (angle8(v, u, atan) * HUES >> 8)];
        colours[2 * pair] = colour_word(left, hue, darkest, eps_white, joined_colours);
        colours[2 * pair + 1] = colour_word(right, hue, darkest, eps_white, joined_colours);
    }
}
