/* Words, their halves and bytes: what other processors compute where the Blackfin has an instruction. */
OPERATOR int32_t low(int32_t x)
{
    return (int16_t)x;
}

OPERATOR int32_t high(int32_t x)
{
    return (int16_t)(x >> 16);
}

OPERATOR int32_t halves(int32_t upper, int32_t lower)
{
    return (int32_t)((uint32_t)upper << 16 | (uint16_t)lower);
}

OPERATOR uint64_t words(int32_t upper, int32_t lower)
{
    return (uint64_t)(uint32_t)upper << 32 | (uint32_t)lower;
}

OPERATOR int32_t byte(int32_t x, int number)
{
    return (uint32_t)x >> 8 * number & 255;
}

OPERATOR int32_t bytes(int32_t b3, int32_t b2, int32_t b1, int32_t b0)
{
    return halves((b3 & 255) << 8 | (b2 & 255), (b1 & 255) << 8 | (b0 & 255));
}

/* The nearest number that fits. */
OPERATOR int16_t nearest_16(int64_t x)
{
    return (int16_t)(x > INT16_MAX ? INT16_MAX : x < INT16_MIN ? INT16_MIN : x);
}

OPERATOR int32_t nearest_32(int64_t x)
{
    return (int32_t)(x > INT32_MAX ? INT32_MAX : x < INT32_MIN ? INT32_MIN : x);
}

OPERATOR int32_t clipped(int32_t x)
{
    return x < 0 ? 0 : x > 255 ? 255 : x;
}

OPERATOR int32_t clip_to(int32_t x, int32_t most)
{
    return x > most ? most : x < -most ? -most : x;
}

/* A product of two fractions without its lowest 16 bits, rounded; what lies in the middle to the even number. */
OPERATOR int32_t rounded(int32_t product)
{
    int64_t doubled = 2 * (int64_t)product;
    return (int32_t)((doubled + 0x7FFF + (doubled >> 16 & 1)) >> 16);
}

/* To the left, or to the right by less than 0; of `places` the lowest six bits count. */
OPERATOR int64_t shifted(int32_t x, uint32_t places)
{
    int by = (int)((places & 63) ^ 32) - 32;
    return by < 0 ? (int64_t)x >> -by : (int64_t)x * ((int64_t)1 << by);
}

OPERATOR int32_t sign_bits(int32_t x)
{
    int32_t count = 0;
    for (uint32_t bits = (uint32_t)(x ^ x >> 31) << 1 | 1; !(bits >> 31); bits <<= 1)
        count++;
    return count;
}

OPERATOR int32_t ones_of(uint32_t x)
{
    int32_t count = 0;
    for (; x; x &= x - 1)
        count++;
    return count;
}

OPERATOR int32_t aligned(int32_t x, int32_t y, int by)
{
    return (int32_t)(words(x, y) >> by);
}

OPERATOR int32_t mean(int32_t x, int32_t y, int number, int up)
{
    return (byte(x, number) + byte(y, number) + up) >> 1;
}

OPERATOR int32_t means(int32_t x, int32_t y, int up)
{
    return bytes(mean(x, y, 3, up), mean(x, y, 2, up), mean(x, y, 1, up), mean(x, y, 0, up));
}

OPERATOR int32_t mean_of_four(int32_t x, int32_t y, int number, int up)
{
    return (byte(x, number) + byte(x, number + 1) + byte(y, number) + byte(y, number + 1) + up) >> 2;
}

OPERATOR int32_t means_of_four(int32_t x, int32_t y, int up)
{
    return halves(mean_of_four(x, y, 2, up), mean_of_four(x, y, 0, up));
}

/* The low bytes of two halves as their high bytes. */
OPERATOR int32_t upper_bytes(int32_t x)
{
    return (int32_t)((uint32_t)x << 8);
}

/* A sum without sign of 16 bits, plus the distance of two bytes. */
OPERATOR int32_t distance(int32_t sum, int32_t x, int32_t y, int number)
{
    int32_t added = (sum & 0xFFFF) + abs(byte(x, number) - byte(y, number));
    return added > 0xFFFF ? 0xFFFF : added;
}
