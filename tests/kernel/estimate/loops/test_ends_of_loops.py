"""Hardware loops whose ends are copied, what is known behind loops, loads before tests, and variables that several choices set."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

WINDOWS = """
def f(a: u8[:], o: u8[:], n: i32, t: i32):
    for x in range(n):
        m = 255
        for k in range(max(x - 4, 0), min(x + (t >> 5), n)):
            m = min(m, a[k])
        o[x] = m
"""
ROWS = """
def f(a: i16[:], b: i16[:], o: i16[:], n: i32, t: i32):
    w = t >> 3
    for i in range(n - w):
        s = 64
        for k in range(w):
            s += a[i + k] * b[k]
        o[i] = s >> 7
"""
STATES = """
def f(a: u16[:], n: i32, t: i32) -> i32:
    state = 0
    k = 0
    for i in range(n):
        w = a[i]
        if state == 0:
            if 100 < w < 300:
                state = 1
        elif state == 1:
            state = 2 if w > 250 else 0
        elif w > t:
            k += w
            state = 0
    return k
"""
COPIES = """
def f(a: u8[:], o: u8[:], n: i32) -> i32:
    k = 0
    for x in range(n):
        left = a[x] & 7
        source = a[x] >> 3
        k &= 127
        while left > 0:
            o[k] = a[source]
            k += 1
            source += 1
            left -= 1
    return k
"""
BLOCKS = """
def f(a: u8[:], n: i32) -> i32:
    low = 0
    high = 0
    at = 0
    left = n
    while left > 0:
        block = left if left < 20 else 20
        left -= block
        while block > 0:
            low += a[at]
            high += low
            at += 1
            block -= 1
        high = (high & 255) + (high >> 8)
    return high + low
"""
RING = """
def f(a: u8[:], o: u8[:], c: i32[:], n: i32, t: i32) -> i32:
    head = 0
    tail = t & 63
    for i in range(n):
        byte = a[i]
        if (head + 1) & 127 == tail:
            c[2] += 1
        else:
            o[head] = byte
            head = (head + 1) & 127
    return head
"""
PROBES = """
def f(a: u8[:], keys: i32[:], n: i32, t: i32) -> i32:
    mask = t - 37
    new = 0
    for x in range(n):
        slot = a[x] & mask
        probes = 0
        while keys[slot] != a[x] and keys[slot] > -400:
            slot = (slot + 1) & mask
            probes += 1
            if probes > mask:
                return -1
        new += slot
    return new
"""
COMBS = """
def f(a: i16[:], s: i32[:], o: i16[:], n: i32) -> i32:
    total = 0
    phase = 0
    k = 0
    for i in range(n):
        total += a[i]
        phase += 1
        if phase == 8:
            phase = 0
            v = total
            for j in range(3):
                d = v - s[j]
                s[j] = v
                v = d
            o[k] = v >> 4
            k += 1
    return k
"""
STEPS = """
def f(a: u8[:], o: i32[:], n: i32, t: i32) -> i32:
    i = 0
    k = 0
    while i < n - 2:
        if a[i] < t:
            i += 1
        elif a[i + 1] > 2 * t:
            o[k & 7] = i
            k += 1
            i += 1
        else:
            k += a[i + 2]
            i += 3
    return k
"""
BYTES = """
def f(a: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    k = 0
    run = 0
    for i in range(n):
        b = a[i]
        if b < t:
            run += b
            if run > 500:
                run -= 300
                o[k] = b
                k += 1
        elif b > 2 * t:
            run = 0
        else:
            o[k] = b
            k += 1
    return k
"""
CASES: dict[str, tuple[str, int, float]] = {
    "the end of a loop stands behind both ways to it, and counts without a hardware loop": (
        WINDOWS,
        8011,
        0.06,
    ),
    "what is 0 if a loop does not run is so before the branch round it": (ROWS, 11892, 0.04),
    "one variable is set by two choices": (STATES, 6299, 0.05),
    "where a loop has written to is computed of how often it went round": (COPIES, 6648, 0.05),
    "of a loop whose test is sure to hold at first, too": (BLOCKS, 804, 0.02),
    "a loop that goes on up to its bound, which may be the largest number, is not counted": (
        PROBES,
        51543,
        0.06,
    ),
    "a test for a loop that is written out is guessed as one for a loop": (COMBS, 4111, 0.01),
    "a step that two blocks end with stands in the code once": (STEPS, 2758, 0.01),
    "but not where the shorter one comes later": (BYTES, 6707, 0.01),
    "a load is done before a test on whose other side something is stored": (RING, 6179, 0.05),
}


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 2, 17, 200)
)
