/* Blocks in a cache of 16 places, in a list by their last use and in chains by their number; how often one was there. */
#include "ref.h"
#include <stddef.h>

#define SEED 3041u
#define N 300
#define PLACES 16
#define EMPTY 0xFFFF

struct entry {
    struct entry *newer, *older; /* by last use, round through `ends` */
    struct entry *chain;         /* in the same bucket */
    uint16_t key;
};

struct cache {
    struct entry ends;
    struct entry entries[PLACES];
    struct entry *buckets[PLACES];
};

static void set_up(struct cache *cache)
{
    struct entry *after = &cache->ends;

    for (int32_t i = 0; i < PLACES; i++) {
        struct entry *entry = &cache->entries[i];
        entry->key = EMPTY;
        entry->newer = after;
        after->older = entry;
        after = entry;
        cache->buckets[i] = NULL;
    }
    after->older = &cache->ends;
    cache->ends.newer = after;
}

KERNEL int32_t lru_cache(struct cache *cache, const uint16_t *blocks, int32_t n, uint16_t *evicted)
{
    struct entry *ends = &cache->ends;
    int32_t hits = 0;

    set_up(cache);
    for (int32_t i = 0; i < n; i++) {
        uint16_t block = blocks[i];
        struct entry **bucket = &cache->buckets[block % PLACES];
        struct entry *entry = *bucket;
        while (entry && entry->key != block)
            entry = entry->chain;
        if (entry) {
            hits++;
        } else {
            entry = ends->newer;
            if (entry->key != EMPTY) {
                struct entry **link = &cache->buckets[entry->key % PLACES];
                *evicted++ = entry->key;
                while (*link != entry)
                    link = &(*link)->chain;
                *link = entry->chain;
            }
            entry->key = block;
            entry->chain = *bucket;
            *bucket = entry;
        }
        entry->older->newer = entry->newer;
        entry->newer->older = entry->older;
        entry->older = ends->older;
        entry->newer = ends;
        ends->older->newer = entry;
        ends->older = entry;
    }
    return hits;
}

int main(void)
{
    static struct cache cache;
    static uint16_t blocks[N], evicted[N];
    uint32_t s = SEED, c0, c1, h = FNV_INIT;

    CYC_ENABLE();
    for (int32_t i = 0; i < N; i++) {
        if (lcg_below(&s, 4))
            blocks[i] = 40 + (i >> 3) + lcg_below(&s, 6);
        else
            blocks[i] = lcg_below(&s, 64);
    }

    CYC_READ(c0);
    int32_t hits = lru_cache(&cache, blocks, N, evicted);
    CYC_READ(c1);

    h = fnv_u16(h, evicted, N);
    h = fnv_i32(h, &hits, 1);
    report("lru_cache", c1 - c0, h);
    PARAMS(SEED, N, "block");
    PARAM("places", PLACES);
    PARAMS_END();
    return 0;
}
