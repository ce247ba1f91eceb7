/* Functions that are called by their addresses: from a table, and handed over. */
#include <stdint.h>

typedef int32_t Step(int32_t sum, const int32_t *value);

static int32_t add(int32_t sum, const int32_t *value)
{
    return sum + *value;
}

static int32_t subtract(int32_t sum, const int32_t *value)
{
    return sum - *value;
}

static int32_t multiply(int32_t sum, const int32_t *value)
{
    return sum * *value;
}

static Step *const STEPS[] = {add, subtract};

int32_t from_table(const int32_t which[], const int32_t values[], int32_t n)
{
    int32_t sum = 1;
    for (int32_t i = 0; i < n; i++)
        sum = STEPS[which[i]](sum, &values[i]);
    return sum;
}

static __attribute__((noinline)) int32_t fold(const int32_t values[], int32_t n, Step *step)
{
    int32_t sum = 1;
    for (int32_t i = 0; i < n; i++)
        sum = step(sum, &values[i]);
    return sum;
}

int32_t handed_over(const int32_t values[], int32_t n)
{
    return fold(values, n, add) - fold(values, n, multiply);
}
