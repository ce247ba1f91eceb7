/* Fill of a level with a stack of pixel numbers; neighbours are pushed if they are within a tolerance. */
#include "ref.h"

#define SEED 1503u
#define W 30
#define H 20

KERNEL int32_t wall_follow(const uint8_t grey[], uint8_t mark[], int32_t w, int32_t h, int32_t start, int32_t tolerance,
                           uint16_t stack[])
{
    int32_t level = grey[start];
    int32_t top = 1;
    int32_t sum = 0;
    stack[0] = (uint16_t)start;
    mark[start] = 1;
    while (top > 0) {
        top = top - 1;
        int32_t p = stack[top];
        sum = sum + grey[p];
        if (p >= w && mark[p - w] == 0 && grey[p - w] <= level + tolerance) {
            mark[p - w] = 1;
            stack[top] = (uint16_t)(p - w);
            top = top + 1;
        }
        if (p < w * (h - 1) && mark[p + w] == 0 && grey[p + w] <= level + tolerance) {
            mark[p + w] = 1;
            stack[top] = (uint16_t)(p + w);
            top = top + 1;
        }
        if (p > 0 && mark[p - 1] == 0 && grey[p - 1] <= level + tolerance) {
            mark[p - 1] = 1;
            stack[top] = (uint16_t)(p - 1);
            top = top + 1;
        }
        if (p < w * h - 1 && mark[p + 1] == 0 && grey[p + 1] <= level + tolerance) {
            mark[p + 1] = 1;
            stack[top] = (uint16_t)(p + 1);
            top = top + 1;
        }
    }
    return sum;
}

int main(void)
{
    static uint8_t grey[W * H], mark[W * H];
    static uint16_t stack[W * H];
    int32_t sum;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        grey[i] = (uint8_t)lcg_u8(&s);
    grey[W * H / 2] = 100;

    CYC_READ(c0);
    sum = wall_follow(grey, mark, W, H, W * H / 2, 80, stack);
    CYC_READ(c1);

    h = fnv_u8(h, mark, W * H);
    h = fnv_val32(h, (uint32_t)sum);
    report("wall_follow", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
