/* Flood fill of the 4-connected region of a start pixel with a stack of pixel
 * numbers; the border of the image is a wall.  Returns the number of pixels. */
#include "ref.h"

#define SEED 1135u
#define W 48
#define H 32
#define START 776
#define COLOUR 2

KERNEL int32_t flood_fill(uint8_t image[], int32_t w, int32_t start, int32_t colour, uint16_t stack[])
{
    int32_t old = image[start];
    int32_t count = 0;
    int32_t sp = 1;
    stack[0] = (uint16_t)start;
    image[start] = (uint8_t)colour;
    while (sp > 0) {
        sp--;
        int32_t p = stack[sp];
        count++;
        if (image[p - 1] == old) {
            image[p - 1] = (uint8_t)colour;
            stack[sp] = (uint16_t)(p - 1);
            sp++;
        }
        if (image[p + 1] == old) {
            image[p + 1] = (uint8_t)colour;
            stack[sp] = (uint16_t)(p + 1);
            sp++;
        }
        if (image[p - w] == old) {
            image[p - w] = (uint8_t)colour;
            stack[sp] = (uint16_t)(p - w);
            sp++;
        }
        if (image[p + w] == old) {
            image[p + w] = (uint8_t)colour;
            stack[sp] = (uint16_t)(p + w);
            sp++;
        }
    }
    return count;
}

int main(void)
{
    static uint8_t image[W * H];
    static uint16_t stack[W * H];
    int32_t count;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    /* one draw per pixel: a wall (1) where the byte is above 180, and on the border */
    for (int32_t y = 0; y < H; y++)
        for (int32_t x = 0; x < W; x++) {
            int32_t wall = lcg_u8(&s) > 180;
            image[y * W + x] = (uint8_t)(wall || x == 0 || y == 0 || x == W - 1 || y == H - 1);
        }
    image[START] = 0;

    CYC_READ(c0);
    count = flood_fill(image, W, START, COLOUR, stack);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_val32(h, (uint32_t)count);
    report("flood_fill", c1 - c0, h);
    PARAMS(SEED, count, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("start", START);
    PARAM("colour", COLOUR);
    PARAMS_END();
    return 0;
}
