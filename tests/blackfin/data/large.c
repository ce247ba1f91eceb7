/* A function whose array is larger than L1, and than the addresses up to the code. */
static unsigned char pixels[3 << 20];

int store(int place, int value)
{
    pixels[place] = value;
    return pixels[place - 1] + pixels[place];
}
