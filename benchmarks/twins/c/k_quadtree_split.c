/* Corner and size of the blocks of a quadtree that are even, or 2 pixels wide. */
#include "ref.h"

#define SEED 2806u
#define SIZE 32
#define MOST 256

KERNEL int32_t quadtree_split(const uint8_t *image, int32_t stride, int32_t size, int32_t tolerance, int16_t stack[],
                              uint8_t leaves[])
{
    int32_t top = 0, count = 0;
    stack[top++] = 0;
    stack[top++] = 0;
    stack[top++] = size;
    while (top > 0) {
        int32_t wide = stack[--top];
        int32_t y0 = stack[--top];
        int32_t x0 = stack[--top];
        int32_t low = 255, high = 0;
        for (int32_t y = y0; y < y0 + wide; y++) {
            for (int32_t x = x0; x < x0 + wide; x++) {
                int32_t v = image[y * stride + x];
                if (v < low)
                    low = v;
                if (v > high)
                    high = v;
            }
        }
        if (high - low <= tolerance || wide <= 2) {
            leaves[3 * count] = x0;
            leaves[3 * count + 1] = y0;
            leaves[3 * count + 2] = wide;
            count++;
        } else {
            int32_t half = wide / 2;
            for (int32_t quarter = 0; quarter < 4; quarter++) {
                stack[top++] = x0 + (quarter & 1) * half;
                stack[top++] = y0 + (quarter >> 1) * half;
                stack[top++] = half;
            }
        }
    }
    return count;
}

int main(void)
{
    static uint8_t image[SIZE * SIZE], leaves[3 * MOST];
    static int16_t stack[64];
    int32_t count;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < SIZE * SIZE; i++)
        image[i] = (uint8_t)(60 + lcg_below(&s, 10));
    for (int32_t y = 7; y < 19; y++)
        for (int32_t x = 5; x < 21; x++)
            image[y * SIZE + x] += 100;

    CYC_READ(c0);
    count = quadtree_split(image, SIZE, SIZE, 16, stack, leaves);
    CYC_READ(c1);

    h = fnv_u8(h, leaves, 3 * MOST);
    h = fnv_val32(h, (uint32_t)count);
    report("quadtree_split", c1 - c0, h);
    PARAMS(SEED, SIZE * SIZE, "pixel");
    PARAM("size", SIZE);
    PARAMS_END();
    return 0;
}
