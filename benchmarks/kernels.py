"""What counting and checking cost, and what compiling costs, over the 20 reference kernels.

    python benchmarks/kernels.py

Side by side in one run: a kernel with counters and with every index checked, as it runs in bfsim; with counters alone; with
neither; and numba's own compilation of the same source. Each is called many times in a row from machine code, in turns; the
least time of a turn counts. Compile times are of a process with an empty kernel cache.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from rich.console import Console
from rich.table import Table

TURNS = 15
TURN_NS = 4_000_000
NAMES = {
    "i8": numba.int8, "u8": numba.uint8, "i16": numba.int16,
    "u16": numba.uint16, "i32": numba.int32, "u32": numba.uint32,
}  # fmt: skip


ENTRY = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)
"""Of a compiled kernel: what it is told besides, its arguments, and what it leaves."""


@dataclass(frozen=True, slots=True)
class Timing:
    """Of one kernel: nanoseconds per call of each variant, milliseconds to compile it cold and to load it warm."""

    kernel: str
    checked_ns: float
    counted_ns: float
    plain_ns: float
    numba_ns: float
    cold_ms: float
    warm_ms: float


@numba.njit
def repeated(entry: Any, arguments: int, left: int, times: int) -> int:
    """Call a compiled kernel many times without coming back to Python."""
    total = 0
    for _ in range(times):
        total += entry(0, arguments, left)
    return total


def arguments_of(case: Any) -> tuple[Any, ...]:
    """Return the arguments of the first call of a twin; every label in its own table, so that calls can repeat."""
    taken: list[tuple[Any, ...]] = []

    def take(*arguments: Any) -> Any:
        taken.append(tuple(each.copy() if isinstance(each, np.ndarray) else each for each in arguments))
        return case.kernel(*arguments)

    case.checksum(take)
    return tuple(
        each % 1024 if isinstance(each, np.ndarray) and case.name == "relabel_rows" else each
        for each in taken[0]
    )


def with_numba(kernel: Any) -> Callable[..., Any]:
    """Compile the source of a kernel, and of those it calls, with numba."""
    text = "\n".join(line for line in kernel.function.source.splitlines() if line.strip() != "@kernel")
    names: dict[str, Any] = dict(NAMES)
    for name, value in kernel.definition.__globals__.items():
        if name in kernel.definition.__code__.co_names and hasattr(value, "function"):
            names[name] = with_numba(value)
    exec(compile("from __future__ import annotations\n" + text, kernel.name, "exec"), names)  # its own source
    return numba.njit(names[kernel.name])


def numba_loop(kernel: Any, arguments: tuple[Any, ...]) -> Callable[[int], Any]:
    """Return a machine-code loop of numba's kernel on these arguments."""
    function = with_numba(kernel)

    @numba.njit
    def loop(times: int, *given: Any) -> None:
        for _ in range(times):
            function(*given)

    return lambda times: loop(times, *arguments)


def our_loop(
    kernel: Any, arguments: tuple[Any, ...], *, counted: bool, checked: bool
) -> Callable[[int], Any]:
    """Return a machine-code loop of our kernel on these arguments."""
    from bfsim.kernel import VDSP_O2, Work
    from bfsim.kernel.host_code.prepared_call import words_of_entry
    from bfsim.machine_code.calling import Taken

    code = kernel.compile(VDSP_O2, counted=counted, checked=checked)
    arrays = [each for each in arguments if isinstance(each, np.ndarray)]
    totals, work, entry = code.new_totals(), Work(0, 0), ENTRY(code.entry)
    words = words_of_entry(kernel.function, arrays, totals)
    given = [arguments[each.position] if isinstance(each, Taken) else each for each in words]
    block = (ctypes.c_int64 * len(given))(*given)

    def loop(times: int, _kept: object = (arrays, totals)) -> int:  # the words have only their addresses
        return int(repeated(entry, ctypes.addressof(block), work.at, times))

    loop(1)
    return loop


def least_ns(loops: list[Callable[[int], Any]]) -> list[float]:
    """Return the least time per call of each loop; they run in turns."""
    times = []
    for loop in loops:
        loop(1)
        start = time.perf_counter_ns()
        loop(10)
        times.append(max(10, int(TURN_NS / max(1, (time.perf_counter_ns() - start) / 10))))
    best = [math.inf] * len(loops)
    for _ in range(TURNS):
        for number, (loop, count) in enumerate(zip(loops, times, strict=True)):
            start = time.perf_counter_ns()
            loop(count)
            best[number] = min(best[number], (time.perf_counter_ns() - start) / count)
    return best


def measure(case: Any) -> Timing:
    """Measure one twin."""
    from bfsim.kernel import VDSP_O2
    from bfsim.kernel.estimate import estimated
    from bfsim.kernel.host_code import jit

    start = time.perf_counter()
    case.kernel.compile(VDSP_O2)
    cold = time.perf_counter() - start
    jit.compile_kernel.cache_clear()
    estimated.costs_of.cache_clear()
    start = time.perf_counter()
    case.kernel.compile(VDSP_O2)
    warm = time.perf_counter() - start
    arguments = arguments_of(case)

    def fresh() -> tuple[Any, ...]:
        return tuple(each.copy() if isinstance(each, np.ndarray) else each for each in arguments)

    checked, counted, plain, other = least_ns(
        [
            our_loop(case.kernel, fresh(), counted=True, checked=True),
            our_loop(case.kernel, fresh(), counted=True, checked=False),
            our_loop(case.kernel, fresh(), counted=False, checked=False),
            numba_loop(case.kernel, fresh()),
        ]
    )
    return Timing(case.name, checked, counted, plain, other, 1000 * cold, 1000 * warm)


def geometric_mean(values: list[float]) -> float:
    """Return the geometric mean."""
    return math.exp(statistics.fmean(map(math.log, values)))


def main() -> None:
    """Measure all, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    os.environ["BFSIM_CACHE_DIR"] = tempfile.mkdtemp()
    from benchmarks.twins.cases import CASES
    from benchmarks.twins.measured import Role, measured
    from bfsim.kernel import VDSP_O2

    known = measured()
    CASES[0].kernel.compile(VDSP_O2, counted=False)  # LLVM itself starts up once
    rows = [measure(case) for case in CASES if known[case.name].role is Role.REFERENCE]
    table = Table(box=None, padding=(0, 1, 0, 0))
    for name in (
        "kernel",
        "checked us",
        "counted us",
        "plain us",
        "checked/counted",
        "counted/plain",
        "numba us",
        "plain/numba",
        "cold ms",
        "warm ms",
    ):
        table.add_column(name, justify="left" if name == "kernel" else "right")
    for each in rows:
        table.add_row(
            each.kernel,
            f"{each.checked_ns / 1000:.2f}", f"{each.counted_ns / 1000:.2f}", f"{each.plain_ns / 1000:.2f}",
            f"{each.checked_ns / each.counted_ns:.2f}", f"{each.counted_ns / each.plain_ns:.2f}",
            f"{each.numba_ns / 1000:.2f}", f"{each.plain_ns / each.numba_ns:.2f}", f"{each.cold_ms:.0f}", f"{each.warm_ms:.1f}",
        )  # fmt: skip
    console = Console(width=None if sys.stdout.isatty() else 110)
    console.print(table)
    checking = geometric_mean([each.checked_ns / each.counted_ns for each in rows])
    counting = geometric_mean([each.counted_ns / each.plain_ns for each in rows])
    against_numba = geometric_mean([each.plain_ns / each.numba_ns for each in rows])
    console.print(f"checked / counted: geometric mean {checking:.2f}")
    console.print(f"counted / plain: geometric mean {counting:.2f}")
    console.print(f"plain / numba: geometric mean {against_numba:.2f}")
    cold, warm = (
        statistics.median(times)
        for times in ([each.cold_ms for each in rows], [each.warm_ms for each in rows])
    )
    console.print(f"compile: median {cold:.0f} ms cold, {warm:.1f} ms warm")


if __name__ == "__main__":
    main()
