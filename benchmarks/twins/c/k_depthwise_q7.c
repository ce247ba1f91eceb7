/* A layer of a network: each channel by its own 3 x 3 weights, scaled to bytes, and nothing below 0. */
#include "ref.h"

#define SEED 3004u
#define W 8
#define H 6
#define CHANNELS 4

struct layer {
    int32_t channels, shift;
    const int8_t *weights; /* 3 x 3 x channels */
    const int32_t *biases;
    const int16_t *scales;
};

KERNEL void depthwise_q7(const int8_t *x, int32_t w, int32_t h, const struct layer *layer, int8_t *out)
{
    const int32_t channels = layer->channels;
    const int32_t half = 1 << (layer->shift - 1);

    for (int32_t row = 0; row < h; row++) {
        for (int32_t column = 0; column < w; column++) {
            for (int32_t c = 0; c < channels; c++) {
                int32_t total = layer->biases[c];
                for (int32_t dy = -1; dy <= 1; dy++) {
                    if (row + dy < 0 || row + dy >= h)
                        continue;
                    for (int32_t dx = -1; dx <= 1; dx++) {
                        if (column + dx < 0 || column + dx >= w)
                            continue;
                        int32_t value = x[((row + dy) * w + column + dx) * channels + c];
                        total += value * layer->weights[(3 * (dy + 1) + dx + 1) * channels + c];
                    }
                }
                int32_t scaled = ((total >> 2) * layer->scales[c] + half) >> layer->shift;
                if (scaled < 0)
                    scaled = 0;
                else if (scaled > INT8_MAX)
                    scaled = INT8_MAX;
                *out++ = scaled;
            }
        }
    }
}

int main(void)
{
    static int8_t x[W * H * CHANNELS], out[W * H * CHANNELS], weights[9 * CHANNELS];
    static int32_t biases[CHANNELS];
    static int16_t scales[CHANNELS];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < W * H * CHANNELS; i++)
        x[i] = lcg_below(&s, 256) - 128;
    for (int32_t i = 0; i < 9 * CHANNELS; i++)
        weights[i] = lcg_below(&s, 256) - 128;
    for (int32_t c = 0; c < CHANNELS; c++)
        biases[c] = lcg_below(&s, 20000) - 10000;
    for (int32_t c = 0; c < CHANNELS; c++)
        scales[c] = lcg_below(&s, 3000) + 1000;
    const struct layer layer = {CHANNELS, 18, weights, biases, scales};

    CYC_READ(c0);
    depthwise_q7(x, W, H, &layer, out);
    CYC_READ(c1);

    h = fnv_u8(h, (const uint8_t *)out, W * H * CHANNELS);
    report("depthwise_q7", c1 - c0, h);
    PARAMS(SEED, W * H * CHANNELS, "value");
    PARAM("w", W);
    PARAM("h", H);
    PARAM("channels", CHANNELS);
    PARAMS_END();
    return 0;
}
