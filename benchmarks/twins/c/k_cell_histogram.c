/* Gradients of a cell of 8 x 8 pixels by octant. */
#include "ref.h"

#define SEED 2801u
#define W 34
#define H 26
#define CELLS 12

KERNEL void cell_histogram(const uint8_t *image, int32_t stride, int32_t x0, int32_t y0, uint16_t bins[8])
{
    for (int32_t b = 0; b < 8; b++)
        bins[b] = 0;
    for (int32_t y = 0; y < 8; y++) {
        const uint8_t *p = image + (y0 + y) * stride + x0;
        for (int32_t x = 0; x < 8; x++, p++) {
            int32_t dx = p[1] - p[-1];
            int32_t dy = p[stride] - p[-stride];
            int32_t octant = 0;
            if (dy < 0) {
                dx = -dx;
                dy = -dy;
                octant = 4;
            }
            if (dx < 0) {
                int32_t turned = -dx;
                dx = dy;
                dy = turned;
                octant += 2;
            }
            if (dy > dx)
                bins[octant + 1] += dy + (dx >> 1);
            else
                bins[octant] += dx + (dy >> 1);
        }
    }
}

int main(void)
{
    static uint8_t image[W * H];
    static uint16_t bins[CELLS * 8];
    uint32_t s = SEED, c0, c1;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++)
        image[i] = (uint8_t)lcg_u8(&s);

    CYC_READ(c0);
    for (int32_t cell = 0; cell < CELLS; cell++)
        cell_histogram(image, W, 1 + 8 * (cell % 4), 1 + 8 * (cell / 4), bins + 8 * cell);
    CYC_READ(c1);

    report("cell_histogram", c1 - c0, fnv_u16(FNV_INIT, bins, CELLS * 8));
    PARAMS(SEED, CELLS * 64, "pixel");
    PARAM("cells", CELLS);
    PARAMS_END();
    return 0;
}
