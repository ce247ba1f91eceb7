/* A motor without brushes by its three Hall sensors: hold it, run it at a speed, let it coast after faults; how many. */
#include "ref.h"

#define SEED 3033u
#define N 600
#define WANTED 9
#define NO_STEP 255
#define HELD 12
#define STALLED 100
#define COASTED 30

enum mode { ALIGN, RUN, COAST };

struct motor {
    enum mode mode;
    uint8_t last;
    int32_t ticks, interval, duty, faults;
};

/* Follow a motor that runs: what it does next. */
static enum mode follow(struct motor *motor, uint8_t step, int32_t wanted)
{
    if (step == NO_STEP || motor->ticks > STALLED)
        return COAST;
    if (step != motor->last) {
        int32_t forward = step - motor->last;
        if (forward < 0)
            forward += 6;
        if (forward != 1)
            return COAST;
        motor->interval += (16 * motor->ticks - motor->interval) >> 2;
        motor->last = step;
        motor->ticks = 0;
    }
    int32_t duty = motor->duty + ((motor->interval - 16 * wanted) >> 4);
    motor->duty = duty < 20 ? 20 : duty > 240 ? 240 : duty;
    return RUN;
}

KERNEL int32_t bldc_commutate(const uint8_t *halls, int32_t n, const uint8_t steps[8], const uint8_t switches[6], int32_t wanted,
                              uint8_t *phases, uint8_t *duties)
{
    struct motor motor = {.mode = ALIGN, .interval = 16 * wanted};

    for (int32_t i = 0; i < n; i++) {
        uint8_t step = steps[halls[i] & 7];
        motor.ticks++;
        switch (motor.mode) {
        case ALIGN:
            motor.duty = 60;
            if (motor.ticks > HELD && step != NO_STEP) {
                motor.mode = RUN;
                motor.last = step;
                motor.ticks = 0;
            }
            break;
        case RUN:
            motor.mode = follow(&motor, step, wanted);
            if (motor.mode == COAST) {
                motor.faults++;
                motor.ticks = 0;
                motor.interval = 16 * wanted;
            }
            break;
        case COAST:
            motor.duty = 0;
            if (motor.ticks > COASTED) {
                motor.mode = ALIGN;
                motor.ticks = 0;
            }
            break;
        }
        switch (motor.mode) {
        case ALIGN:
            phases[i] = switches[0];
            break;
        case RUN:
            phases[i] = switches[(motor.last + 2) % 6];
            break;
        case COAST:
            phases[i] = 0;
            break;
        }
        duties[i] = motor.duty;
    }
    return motor.faults;
}

int main(void)
{
    static const uint8_t steps[8] = {NO_STEP, 0, 2, 1, 4, 5, 3, NO_STEP};
    static const uint8_t order[6] = {1, 3, 2, 6, 4, 5};
    static const uint8_t switches[6] = {0x21, 0x09, 0x18, 0x12, 0x06, 0x24};
    static uint8_t halls[N], phases[N], duties[N];
    int32_t turn = 0, speed = 0;
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        if (i % 200 > 12 && speed < 100)
            speed++;
        turn = (turn + speed + lcg_below(&s, 20)) % 6000;
        halls[i] = i == 250 || i == 470 ? 7 : order[turn / 1000];
    }

    CYC_READ(c0);
    int32_t faults = bldc_commutate(halls, N, steps, switches, WANTED, phases, duties);
    CYC_READ(c1);

    h = fnv_u8(h, phases, N);
    h = fnv_u8(h, duties, N);
    h = fnv_i32(h, &faults, 1);
    report("bldc_commutate", c1 - c0, h);
    PARAMS(SEED, N, "tick");
    PARAM("wanted", WANTED);
    PARAMS_END();
    return 0;
}
