/* Regions of set pixels, with all eight neighbours, by fills with a stack. Returns how many; the largest goes to size[0]. */
#include "ref.h"

#define SEED 1404u
#define W 24
#define H 18

KERNEL int32_t count_islands(uint8_t image[], int32_t w, int32_t h, int16_t stack[], int32_t size[])
{
    int32_t islands = 0;
    int32_t largest = 0;
    for (int32_t start = 0; start < w * h; start++) {
        if (image[start] != 1) {
            continue;
        }
        int32_t top = 0;
        int32_t pixels = 0;
        stack[top] = (int16_t)start;
        top++;
        image[start] = 2;
        while (top > 0) {
            top--;
            int32_t p = stack[top];
            int32_t y = p / w;
            int32_t x = p - y * w;
            pixels++;
            for (int32_t dy = -1; dy <= 1; dy++) {
                for (int32_t dx = -1; dx <= 1; dx++) {
                    if (x + dx < 0 || x + dx >= w || y + dy < 0 || y + dy >= h) {
                        continue;
                    }
                    int32_t q = p + dy * w + dx;
                    if (image[q] == 1) {
                        image[q] = 2;
                        stack[top] = (int16_t)q;
                        top++;
                    }
                }
            }
        }
        islands++;
        if (pixels > largest) {
            largest = pixels;
        }
    }
    size[0] = largest;
    return islands;
}

int main(void)
{
    static uint8_t image[W * H];
    static int16_t stack[W * H];
    static int32_t size[1];
    int32_t islands;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = lcg_u8(&s) < 80;

    CYC_READ(c0);
    islands = count_islands(image, W, H, stack, size);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_i32(h, size, 1);
    h = fnv_val32(h, (uint32_t)islands);
    report("count_islands", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
