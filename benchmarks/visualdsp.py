"""The run-time library of VisualDSP++ as it is: routines of a program that it linked, beside what their manual says of their cycles.

    python -m benchmarks.visualdsp PROGRAM.dxe

PROGRAM is any program of VisualDSP++ or CrossCore for the Blackfin that divides and uses floats; none comes with bfsim,
but public repositories have some. Each routine is called with operands of all sizes, spread evenly over their
exponents; what it returns must be right. Cycles are those of `gcc-adi`, the call included as in the manual.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

import numpy as np
from rich.console import Console
from rich.table import Table

from bfsim.api import f32, i32, kernel_from, u32
from bfsim.errors import KernelError
from bfsim.kernel import Kernel
from bfsim.kernel.types import Number

CALL_CCLK = 5
CALLS = 2000
SEED = 1


@dataclass(frozen=True, slots=True)
class Routine:
    """A routine, its operands and result, what it computes, and its cycles by the manual [VLIB]; nothing where that does not say."""

    name: str
    operands: tuple[Number, ...]
    result: Number
    value: Callable[..., object]
    documented: str = ""


def quotient(one: int, other: int) -> int:
    """Return a quotient as C has it, towards zero."""
    return abs(one) // abs(other) * (1 if (one < 0) == (other < 0) else -1)


ROUTINES = (
    Routine("__div32", (i32, i32), i32, quotient, "25-91, average 52"),
    Routine("__udiv32", (u32, u32), u32, quotient),
    Routine("__float32_add", (f32, f32), f32, np.add, "30-103, average 73"),
    Routine("__float32_sub", (f32, f32), f32, np.subtract),
    Routine("__float32_mul", (f32, f32), f32, np.multiply, "41-146, typically 71"),
    Routine("__float32_div", (f32, f32), f32, np.divide),
    Routine("__int32_to_float32", (i32,), f32, np.float32),
    Routine("__float32_to_int32_round_to_zero", (f32,), i32, int),
)


def operand(kind: Number, rng: np.random.Generator) -> int | np.float32:
    """Return a number of any size that a kind has, but for floats near its ends."""
    magnitude = 2.0 ** rng.uniform(0, 31 if kind is not f32 else 20)
    sign = 1 if kind is u32 or rng.random() < 0.5 else -1
    return np.float32(sign * magnitude) if kind is f32 else int(sign * magnitude)


def measured(routine: Routine, kernel: Kernel) -> Iterator[tuple[int, bool]]:
    """Yield the cycles of each call, and whether it returned what it should."""
    rng = np.random.default_rng(SEED)
    for _ in range(CALLS):
        operands = [operand(each, rng) for each in routine.operands]
        right = np.isclose(float(kernel(*operands)), float(routine.value(*operands)), rtol=1e-6, atol=0)  # type: ignore[arg-type]
        yield kernel.cost(*operands) + CALL_CCLK, bool(right)


def main() -> None:
    """Print a row for each routine that the program has."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=Path)
    program = parser.parse_args().program.resolve()
    table = Table(
        title=f"{program.name}: cycles of the library, {CALLS:,} calls of each",
        title_justify="left",
        box=None,
    )
    for name in ("routine", "least", "most", "mean", "right", "by the manual"):
        table.add_column(name, justify="left" if name in ("routine", "by the manual") else "right")
    for routine in ROUTINES:
        parameters = dict(zip("ab", routine.operands, strict=False))
        try:
            kernel = kernel_from(program, routine.name, result=routine.result, **parameters)
        except KernelError as error:
            table.add_row(routine.name, *["-"] * 4, str(error)[:40])
            continue
        cycles, right = zip(*measured(routine, kernel), strict=True)
        row = f"{min(cycles)}", f"{max(cycles)}", f"{mean(cycles):.0f}", f"{mean(right):.1%}"
        table.add_row(routine.name, *row, routine.documented)
    Console().print(table)


if __name__ == "__main__":
    main()
