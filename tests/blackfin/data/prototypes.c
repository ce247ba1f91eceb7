/* Parameters of each kind, for tests/test_declared.py. */
typedef unsigned char byte;
struct state { int at; };
enum pace { SLOW, FAST };

int sum(const byte *row, int n)
{
    int total = 0;
    for (int i = 0; i < n; i++)
        total += row[i];
    return total;
}

void step(const short *restrict gains, struct state *state, void *scratch, float by, enum pace pace)
{
    state->at += gains[pace] + (int)by + *(byte *)scratch;
}

int any(int first, ...) { return first; }

int untold() { return 1; }

double wide(double x, int n) { return n ? x : -x; }

long long ticks(int n) { return (long long)n << 20; }

int at(struct state state) { return state.at; }

void halve(double *values, int n)
{
    for (int i = 0; i < n; i++)
        values[i] /= 2;
}

int state_of(const struct state *state) { return state->at; }

byte darker(const byte *row, byte limit, short by)
{
    return row[row[0] > limit] - by;
}
