/* Functions that keep something from call to call. */
static int sum = 100;

void begin(int from)
{
    sum = from;
}

int add(int value)
{
    return sum += value;
}
