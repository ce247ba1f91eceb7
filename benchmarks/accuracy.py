"""How near the cost model is to GCC's code on the Blackfin: cycles and operations, kernel by kernel.

    python benchmarks/accuracy.py                 -O2, all kernels
    python benchmarks/accuracy.py --level O0
    python benchmarks/accuracy.py --json

Measured: GCC 12.2 and the GNU simulator 13.1 (see `twins/measure.py`). `left out` is the error without the rules that
were learnt from this kernel alone (`bfsim/kernel/learnt.py`), the leave-one-out error; the held-out kernels were
not used to find rules. Classes: predicted minus measured operations, in percent of all operations measured.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from benchmarks.twins.cases import CASES
from benchmarks.twins.measured import CLASSES, Measured, Role, by_class, measured
from benchmarks.twins.predicted import predict
from bfsim.kernel import GCC_O0, GCC_O2, CompilerProfile
from bfsim.kernel.learnt import LEARNT_FROM

PROFILES = {"O0": GCC_O0, "O2": GCC_O2}

# The classes whose names are wider than their numbers.
HEADS = {
    "stores": "store",
    "shifts": "shift",
    "multiplies": "mul",
    "compares": "cmp",
    "not taken": "not\ntaken",
}


@dataclass(frozen=True, slots=True)
class Comparison:
    """One kernel. Errors in percent of the measured cycles; `classes` in percent of all measured operations."""

    kernel: str
    role: str
    predicted_cycles: int
    measured_cycles: int
    error: float
    error_left_out: float
    classes: dict[str, float]


def compare(level: str) -> Iterator[Comparison]:
    """Compare every twin that has been measured."""
    known = measured()
    for case in CASES:
        truth, profile = known[case.name], PROFILES[level]
        found = predict(case, profile)
        without = _without(case.name, profile)
        left_out = found if without is profile else predict(case, without)
        yield Comparison(
            kernel=case.name,
            role=truth.role.value,
            predicted_cycles=found.cycles,
            measured_cycles=truth.cycles[level],
            error=_error(found.cycles, truth, level),
            error_left_out=_error(left_out.cycles, truth, level),
            classes=_classes(found.operations, truth.operations[level]),
        )


def _without(kernel: str, profile: CompilerProfile) -> CompilerProfile:
    rules = tuple(rule for rule, kernels in LEARNT_FROM.items() if kernels == (kernel,))
    return dataclasses.replace(profile, without=rules) if rules and profile.optimises else profile


def _error(cycles: int, truth: Measured, level: str) -> float:
    return 100 * (cycles / truth.cycles[level] - 1)


def _classes(predicted: dict[str, int], truth: dict[str, int]) -> dict[str, float]:
    ours, theirs, whole = by_class(predicted), by_class(truth), sum(truth.values())
    return {group: 100 * (ours[group] - theirs[group]) / whole for group in CLASSES}


def summary(rows: Sequence[Comparison], role: Role) -> dict[str, float]:
    """Return the mean and the largest error of the kernels of a role, as they are and left out."""
    errors = [abs(each.error) for each in rows if each.role == role]
    left_out = [abs(each.error_left_out) for each in rows if each.role == role]
    return {
        "kernels": len(errors),
        "mean": sum(errors) / len(errors),
        "largest": max(errors),
        "mean_left_out": sum(left_out) / len(left_out),
        "largest_left_out": max(left_out),
    }


def sorted_rows(rows: Sequence[Comparison], role: Role) -> list[Comparison]:
    """Return the kernels of a role, the worst one first."""
    return sorted((row for row in rows if row.role == role), key=lambda row: -abs(row.error))


def cycle_table(rows: Sequence[Comparison], level: str) -> Table:
    """Return cycles and their errors, the reference kernels first."""
    result = _new_table(f"gcc -{level}: cycles predicted and measured")
    for name in ("cycles", "measured", "error %", "left out"):
        result.add_column(name, justify="right")
    for role in Role:
        for each in sorted_rows(rows, role):
            errors = f"{each.error:+.1f}", f"{each.error_left_out:+.1f}"
            result.add_row(each.kernel, f"{each.predicted_cycles:,}", f"{each.measured_cycles:,}", *errors)
        sums = summary(rows, role)
        means = f"{sums['mean']:.1f}", f"{sums['mean_left_out']:.1f}"
        result.add_row(
            f"{role.value}: mean of {sums['kernels']:.0f}", "", "", *means, style="bold", end_section=True
        )
    return result


def class_table(rows: Sequence[Comparison], level: str) -> Table:
    """Return the errors of the classes of operations, in the same order; they fit 80 columns."""
    result = _new_table(f"gcc -{level}: operations predicted minus measured, % of all measured")
    for name in CLASSES:
        result.add_column(HEADS.get(name, name), justify="right")
    for role in Role:
        for each in sorted_rows(rows, role):
            result.add_row(
                each.kernel,
                *(f"{value:+.1f}" if abs(value) >= 0.05 else "·" for value in each.classes.values()),
            )
        result.add_section()
    return result


def _new_table(title: str) -> Table:
    result = Table(title=title, title_justify="left", box=None, padding=(0, 1, 0, 0), pad_edge=False)
    result.add_column("kernel", no_wrap=True)
    return result


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--level", choices=list(PROFILES), default="O2", help="optimisation level of GCC")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    options = parser.parse_args()
    rows = list(compare(options.level))
    if options.json:
        sums = {role.value: summary(rows, role) for role in Role}
        print(
            json.dumps(
                {
                    "level": options.level,
                    "summary": sums,
                    "kernels": [dataclasses.asdict(each) for each in rows],
                },
                indent=2,
            )
        )
        return
    console = Console()
    console.print(cycle_table(rows, options.level))
    console.print(class_table(rows, options.level))
    for role in Role:
        sums = summary(rows, role)
        line = f"{role.value}: mean {sums['mean']:.1f} %, largest {sums['largest']:.1f} %"
        console.print(
            f"{line}; left out: mean {sums['mean_left_out']:.1f} %, largest {sums['largest_left_out']:.1f} %"
        )


if __name__ == "__main__":
    main()
