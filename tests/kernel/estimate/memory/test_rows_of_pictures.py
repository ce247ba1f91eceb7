"""Pictures by rows: addresses made of sums and products, pointers of rows, lines drawn across them, and loops that hand values on."""

from __future__ import annotations

from pathlib import Path

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.estimate.ranges.value_ranges import answer, value_range
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import arguments, beside_gcc
from tests.kernel.lowered import lowered
from tests.kernel.modules import kernel_of

LOOKED_UP = """
def f(a: {0}[:], xs: i32[:], ys: i32[:], o: i16[:], n: i32) -> None:
    w = n >> 4
    for i in range(n):
        x = xs[i] & 15
        y = ys[i] & 15
        o[i] = {1}
"""
IN_ROWS = """
def f(a: u16[:], xs: i32[:], o: u16[:], n: i32) -> None:
    w = n >> 4
    for y in range(w):
        for i in range(8):
            o[y * w + i] = a[y * w + (xs[i] & 15)]
"""
LINE = """
def f(a: u8[:], ends: u8[:], n: i32) -> i32:
    passed = 0
    for k in range(0, n - 1, 2):
        x, y = 3, 5
        x1 = ends[k] & 15
        y1 = ends[k + 1] & 15
        dx = abs(x1 - x)
        dy = -abs(y1 - y)
        sx = 1 if x < x1 else -1
        sy = 1 if y < y1 else -1
        err = dx + dy
        while x != x1 or y != y1:
            a[16 * y + x] = 7
            e2 = 2 * err
            if e2 >= dy:
                err += dy
                x += sx
            if e2 <= dx:
                err += dx
                y += sy
            passed += 1
    return passed
"""
DISTANCES = """
def f(a: u8[:], n: i32) -> None:
    w = n >> 4
    for y in range(w - 2, 0, -1):
        for x in range(w - 2, 0, -1):
            p = y * w + x
            d = a[p]
            if d > 100:
                d = min(d, a[p + 1] + 3)
                d = min(d, min(a[p + w + 1] + 4, a[p + w] + 3))
                d = min(d, a[p + w - 1] + 4)
                a[p] = d
"""
HANDED_ON = """
def f(a: i16[:], b: i16[:], o: i16[:], t: i32, n: i32) -> None:
    x1, x2 = 1, 2
    for i in range(n):
        x0 = a[i]
        if x0 > t:
            x0 = b[i]
        o[i] = (x0 + 2 * x1 + x2) >> 2
        x2, x1 = x1, x0
"""
OF_ONE_BLOCK = """
def f(a: i16[:], o: i32[:], n: i32) -> None:
    y1 = 1
    y2 = 1
    for i in range(n):
        y = a[i] + ((3 * y1 - y2) >> 2)
        y2 = y1
        y1 = y
        o[i] = y
"""
VOTES = """
def f(a: u8[:], b: i16[:], c: i16[:], o: u16[:], n: i32) -> None:
    w = n >> 4
    for y in range(w):
        for x in range(w):
            if a[y * w + x] < 100:
                continue
            for k in range(w):
                o[k * 16 + ((x * b[k] + y * c[k]) >> 10 & 15)] += 1
"""
STORED = """
def f(a: i16[:], o: i16[:], t: i32, n: i32) -> i32:
    lost = 0
    for i in range(n):
        v = (a[i] * 3) >> 1
        if v < t:
            o[i] = 0
            lost += 1
        else:
            o[i] = v
    return lost
"""
BORDERS = """
def f(a: u8[:], o: u16[:], n: i32) -> i32:
    w = n >> 4
    k = 0
    for y in range(w):
        for x in range(w):
            at = y * w + x
            o[at] = 0
            if a[at] < 100:
                continue
            up = o[at - w] if y > 0 else 0
            left = o[at - 1] if x > 0 else 0
            if up == 0 and left == 0:
                k += 1
                o[at] = k
            else:
                o[at] = max(up, left)
    return k
"""
SQUARE = "a[y * w + x] + a[y * w + x + 1] + a[(y + 1) * w + x] + a[(y + 1) * w + x + 1]"

# Without these rules estimates are off by up to 73 %.
CASES = {
    "a byte": (LOOKED_UP.format("u8", "a[y * w + x]"), 2444, 0.1),
    "a half-word": (LOOKED_UP.format("i16", "a[y * w + x]"), 2647, 0.02),
    "a table": (LOOKED_UP.format("i16", "a[4 * y + x]"), 2045, 0.11),
    "a byte and the one below": (LOOKED_UP.format("u8", "a[y * w + x] + a[y * w + x + 1]"), 3047, 0.02),
    "a square": (LOOKED_UP.format("i16", SQUARE), 5048, 0.05),
    "a square of bytes": (LOOKED_UP.format("u8", SQUARE), 4447, 0.1),
    "two rows apart": (LOOKED_UP.format("i16", "a[(y + 2) * w + x] - a[y * w + x]"), 4248, 0.02),
    "in rows": (IN_ROWS, 862, 0.12),
    "a line": (LINE, 32258, 0.02),
    "distances": (DISTANCES, 2050, 0.07),
    "values handed on": (HANDED_ON, 3958, 0.09),
    "in one block": (OF_ONE_BLOCK, 5227, 0.05),
    "votes": (VOTES, 25386, 0.03),
    "borders": (BORDERS, 3528, 0.12),
    "one of two stores": (STORED, 2667, 0.02),
}


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 2, 17, 90)
)


RANGES = """
define i32 @f(i32 %x, i32 %e, i16 %h) {
entry:
  %dx = call i32 @llvm.abs.i32(i32 %x, i1 false)
  %dy = sub i32 0, %dx
  %half = sext i16 %h to i32
  %above = icmp sge i32 %e, %dy
  %below = icmp sle i32 %e, %dx
  %known = icmp slt i32 %e, %half
  %large = icmp sgt i32 %e, 40000
  ret i32 0
}
"""


def test_ranges_say_what_a_test_answers() -> None:
    """Where `e` is below what is not positive, it is not above what is not negative; where it is not, nobody knows."""
    (routine,) = read_module(RANGES)
    flow = ControlFlow(routine)
    above, below, known, large = (
        flow.instruction(f"%{name}") for name in ("above", "below", "known", "large")
    )
    assert above and below and known and large
    assert value_range(flow, "%dx") == (0, 2**31 - 1)
    assert value_range(flow, "%dy") == (-(2**31) + 1, 0)
    assert value_range(flow, "%half") == (-32768, 32767)
    assert value_range(flow, "%e") == (-(2**31), 2**31 - 1)
    assert answer(flow, above, below, holds=False) is True
    assert answer(flow, above, below, holds=True) is None
    assert answer(flow, known, large, holds=True) is False
    assert answer(flow, known, large, holds=False) is None
    assert answer(flow, below, known, holds=False) is None


def test_the_second_step_of_a_line_is_asked_for_behind_the_first_alone(tmp_path: Path) -> None:
    """Where Bresenham's line does not go on in x, it goes on in y: as often as it goes on in x, `e2 <= dx` is tested."""
    kernel = kernel_of(LINE, tmp_path)
    picture, ends, count = arguments(kernel)
    code = kernel.compile(GCC_O2)
    totals = code.new_totals()
    iterations = kernel.prepare(code, [picture, ends], totals).run(picture, ends, count).value
    line = LINE.splitlines().index("            if e2 <= dx:") + 1
    tests = sum(
        events * each.times
        for counter, events in zip(code.counters, totals.tolist(), strict=True)
        for each in counter.charges
        if each.op is Op.COMPARE and each.line.line == line
    )
    steps = sum(abs(int(x & 15) - 3) for x in ends[: count - 1 : 2])
    assert tests == steps < (iterations or 0)


def test_values_are_handed_on_in_front_of_a_hardware_loop(tmp_path: Path) -> None:
    """Of several blocks; where there is one, or by VisualDSP++, of which nothing says so, the loop is none."""
    several, one = (CASES[name][0] for name in ("values handed on", "in one block"))
    assert lowered(several, tmp_path, GCC_O2)[Op.LOOP_SETUP] == 1
    assert lowered(several, tmp_path, VDSP_O2)[Op.LOOP_SETUP] == 0
    assert lowered(one, tmp_path, GCC_O2)[Op.LOOP_SETUP] == 0


def test_a_product_of_the_next_row_is_none(tmp_path: Path) -> None:
    """(y + 2) * w beside y * w is a sum."""
    text = CASES["two rows apart"][0]
    assert lowered(text, tmp_path, GCC_O2)[Op.MUL32] == 1
    assert lowered(text, tmp_path, VDSP_O2)[Op.MUL32] == 2
