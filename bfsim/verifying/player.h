/* player.h - what the program that plays recorded calls is made of, but for the kernels. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RTS_CYCLES 5
#define END 0xFFFFFFFFu
#define NOT_INLINED __attribute__((noipa))

/* The cycles of a call, from its first operation to its RTS: those of the same call of a function that only returns are
 * subtracted, but for its RTS. */
#ifdef __BFIN__
__asm__(".text; .global _nothing; _nothing: RTS;");
extern void nothing(void);
#define ENABLE() __asm__ volatile("R0=SYSCFG; BITSET(R0,1); SYSCFG=R0; CSYNC;" ::: "R0", "CC")
#define CYCLES(c) __asm__ volatile("%0 = CYCLES;" : "=d"(c) :: "memory")
#else
static void nothing(void) {}
#define ENABLE() ((void)0)
#define CYCLES(c) ((c) = 0u)
#endif

static FILE *input;
static uint32_t sum;

static void take(void *to, size_t size)
{
    if (fread(to, 1, size, input) != size)
        exit(3);
}

static uint32_t take_word(void)
{
    uint32_t word;
    take(&word, sizeof word);
    return word;
}

static inline float take_float(void)
{
    float number;
    take(&number, sizeof number);
    return number;
}

static inline void *take_array(uint32_t *size)
{
    *size = take_word();
    void *array = malloc(*size ? *size : 1);
    uint32_t padding;
    if (array == NULL)
        exit(4);
    take(array, *size);
    take(&padding, -*size & 3);
    return array;
}

static void add(uint32_t word)
{
    sum = sum * FACTOR_OF_CHECKSUM + word;
}

static inline void leave_array(void *array, uint32_t size)
{
    uint32_t at, word;
    for (at = 0; at + 4 <= size; at += 4) {
        memcpy(&word, (char *)array + at, 4);
        add(word);
    }
    if (at < size) {
        word = 0;
        memcpy(&word, (char *)array + at, size - at);
        add(word);
    }
    free(array);
}

static void told(uint32_t spent, uint32_t result)
{
    add(result);
    printf("%lu %lu\n", (unsigned long)spent, (unsigned long)sum);
    sum = 0;
}

#define PLAYER_MAIN(players)                        \
    int main(void)                                  \
    {                                               \
        uint32_t number;                            \
        ENABLE();                                   \
        input = fopen("calls.bin", "rb");           \
        if (input == NULL)                          \
            return 5;                               \
        while ((number = take_word()) != END)       \
            players[number]();                      \
        return 0;                                   \
    }
