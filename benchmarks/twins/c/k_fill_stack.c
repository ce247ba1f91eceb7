/* Fill of four neighbours from a seed, with a stack of positions. Returns how many were filled. */
#include "ref.h"

#define SEED 1206u
#define W 32
#define H 32

KERNEL int32_t fill_stack(uint8_t image[], int32_t w, int32_t h, int32_t start, int32_t colour, int32_t stack[])
{
    int32_t old = image[start];
    int32_t count = 0;
    int32_t top = 0;
    stack[top++] = start;
    while (top > 0) {
        int32_t p = stack[--top];
        if (image[p] != old) {
            continue;
        }
        image[p] = (uint8_t)colour;
        count++;
        int32_t x = p & (w - 1);
        if (x > 0) {
            stack[top++] = p - 1;
        }
        if (x < w - 1) {
            stack[top++] = p + 1;
        }
        if (p >= w) {
            stack[top++] = p - w;
        }
        if (p < w * (h - 1)) {
            stack[top++] = p + w;
        }
    }
    return count;
}

int main(void)
{
    static uint8_t image[W * H];
    static int32_t stack[4 * W * H];
    int32_t count;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = lcg_u8(&s) < 64;
    image[W * H / 2 + W / 2] = 0;

    CYC_READ(c0);
    count = fill_stack(image, W, H, W * H / 2 + W / 2, 7, stack);
    CYC_READ(c1);

    h = fnv_u8(h, image, W * H);
    h = fnv_val32(h, (uint32_t)count);
    report("fill_stack", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
