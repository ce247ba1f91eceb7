/* Charge in percent: currents are counted, and at rest the voltage's curve is believed; how often it got low. */
#include "ref.h"
#include <stdbool.h>
#include <stdlib.h>

#define SEED 2923u
#define N 200
#define KNOTS 11
#define FULL (1000 << 8)
#define AT_REST 200

KERNEL int32_t battery_gauge(const uint16_t *millivolts, const int16_t *milliamperes, int32_t n, const uint16_t curve[KNOTS],
                             uint8_t *charges)
{
    int32_t charge = FULL / 2, warnings = 0;
    bool low = false;
    for (int32_t i = 0; i < n; i++) {
        int32_t current = milliamperes[i];
        charge -= current;
        if (abs(current) < AT_REST) {
            int32_t volts = millivolts[i];
            int32_t k = 0;
            while (k < KNOTS - 2 && volts >= curve[k + 1])
                k++;
            int32_t share = 100 * (volts - curve[k]) / (curve[k + 1] - curve[k]);
            if (share < 0)
                share = 0;
            if (share > 100)
                share = 100;
            int32_t believed = (100 * k + share) << 8;
            charge += (believed - charge) >> 4;
        }
        if (charge < 0)
            charge = 0;
        if (charge > FULL)
            charge = FULL;
        int32_t percent = charge / (FULL / 100);
        if (!low && percent < 20) {
            low = true;
            warnings++;
        } else if (low && percent > 25) {
            low = false;
        }
        charges[i] = percent;
    }
    return warnings;
}

int main(void)
{
    static const uint16_t curve[KNOTS] = {3000, 3300, 3450, 3550, 3620, 3680, 3750, 3830, 3920, 4050, 4200};
    static uint16_t volts[N];
    static int16_t current[N];
    static uint8_t charges[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        volts[i] = 3900 - 4 * i + lcg_below(&s, 60);
        current[i] = i >> 4 & 1 ? lcg_below(&s, 150) : 600 + lcg_below(&s, 1500);
    }

    CYC_READ(c0);
    int32_t warnings = battery_gauge(volts, current, N, curve, charges);
    CYC_READ(c1);

    h = fnv_u8(h, charges, N);
    h = fnv_i32(h, &warnings, 1);
    report("battery_gauge", c1 - c0, h);
    PARAMS(SEED, N, "sample");
    PARAM("n", N);
    PARAMS_END();
    return 0;
}
