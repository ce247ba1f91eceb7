/* One period of a motor's field-oriented control: two currents and an angle in, three duties out. */
#include "ref.h"

#define SEED 2922u
#define PERIODS 40

struct sums {
    int32_t d, q;
};

static inline int32_t clamp(int32_t value, int32_t limit)
{
    if (value > limit)
        return limit;
    if (value < -limit)
        return -limit;
    return value;
}

KERNEL void field_currents(int32_t a, int32_t b, int32_t angle, int32_t wanted, const int16_t sines[256], struct sums *sums,
                           int16_t duties[3])
{
    int32_t sine = sines[angle & 255];
    int32_t cosine = sines[(angle + 64) & 255];

    int32_t alpha = a;
    int32_t beta = ((a + 2 * b) * 18919) >> 15;
    int32_t error_d = -((alpha * cosine + beta * sine) >> 15);
    int32_t error_q = wanted - ((beta * cosine - alpha * sine) >> 15);

    sums->d = clamp(sums->d + error_d, 8000);
    sums->q = clamp(sums->q + error_q, 8000);
    int32_t d = clamp((3 * error_d + (sums->d >> 2)) >> 2, 900);
    int32_t q = clamp((3 * error_q + (sums->q >> 2)) >> 2, 900);

    alpha = (d * cosine - q * sine) >> 15;
    beta = (d * sine + q * cosine) >> 15;
    int32_t half = (beta * 28378) >> 15;
    int32_t u = alpha;
    int32_t v = half - (alpha >> 1);
    int32_t w = -half - (alpha >> 1);

    int32_t most = u, least = u;
    if (v > most)
        most = v;
    if (w > most)
        most = w;
    if (v < least)
        least = v;
    if (w < least)
        least = w;
    int32_t middle = (most + least) >> 1;
    duties[0] = 1000 + u - middle;
    duties[1] = 1000 + v - middle;
    duties[2] = 1000 + w - middle;
}

int main(void)
{
    static int16_t sines[256], duties[PERIODS][3];
    int32_t a[PERIODS], b[PERIODS];
    struct sums sums = {0, 0};
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < 256; i++) {
        int32_t turn = i & 127;
        sines[i] = 7 * turn * (128 - turn) * (i < 128 ? 1 : -1);
    }
    for (int32_t i = 0; i < PERIODS; i++) {
        a[i] = lcg_below(&s, 2001) - 1000;
        b[i] = lcg_below(&s, 2001) - 1000;
    }

    CYC_READ(c0);
    for (int32_t i = 0; i < PERIODS; i++)
        field_currents(a[i], b[i], 11 * i, 300, sines, &sums, duties[i]);
    CYC_READ(c1);

    h = fnv_i16(h, duties[0], 3 * PERIODS);
    h = fnv_i32(h, &sums.d, 2);
    report("field_currents", c1 - c0, h);
    PARAMS(SEED, PERIODS, "period");
    PARAM("periods", PERIODS);
    PARAMS_END();
    return 0;
}
