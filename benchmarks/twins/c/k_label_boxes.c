/* Left, top, right, bottom and area of each label; 0 is background. */
#include "ref.h"

#define SEED 2805u
#define W 64
#define H 40
#define COUNT 12

struct box {
    int16_t left, top, right, bottom;
};

KERNEL void label_boxes(const uint8_t *labels, int32_t w, int32_t h, int32_t count, struct box boxes[], uint16_t areas[])
{
    for (int32_t i = 0; i < count; i++) {
        boxes[i].left = w;
        boxes[i].top = h;
        boxes[i].right = -1;
        boxes[i].bottom = -1;
        areas[i] = 0;
    }
    for (int32_t y = 0; y < h; y++) {
        for (int32_t x = 0; x < w; x++) {
            int32_t label = labels[y * w + x];
            if (label == 0)
                continue;
            struct box *box = &boxes[label - 1];
            areas[label - 1]++;
            if (x < box->left)
                box->left = x;
            if (y < box->top)
                box->top = y;
            if (x > box->right)
                box->right = x;
            if (y > box->bottom)
                box->bottom = y;
        }
    }
}

int main(void)
{
    static uint8_t labels[W * H];
    static struct box boxes[COUNT];
    static uint16_t areas[COUNT];
    int32_t label = 0;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H; i++) {
        if (lcg_below(&s, 5) == 0) {
            int32_t shown = lcg_below(&s, 2);
            label = shown * lcg_below(&s, 13);
        }
        labels[i] = (uint8_t)label;
    }

    CYC_READ(c0);
    label_boxes(labels, W, H, COUNT, boxes, areas);
    CYC_READ(c1);

    h = fnv_i16(h, &boxes[0].left, 4 * COUNT);
    h = fnv_u16(h, areas, COUNT);
    report("label_boxes", c1 - c0, h);
    PARAMS(SEED, W * H, "pixel");
    PARAM("w", W);
    PARAM("h", H);
    PARAMS_END();
    return 0;
}
