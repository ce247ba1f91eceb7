"""How near the cost model is to GCC's code on the Blackfin: cycles and operations, kernel by kernel.

    python benchmarks/accuracy.py                 -O2, all kernels
    python benchmarks/accuracy.py --level O0
    python benchmarks/accuracy.py --json
    python benchmarks/accuracy.py --rules         which kernels need each rule; takes minutes
    python benchmarks/accuracy.py --ablate        what each rule is worth; takes minutes
    python benchmarks/accuracy.py --ablate RULE   only these

Measured: GCC 12.2 and the GNU simulator 13.1 (see `twins/measure.py`). The first figures are what to expect of a kernel
that is not in the list: by how much the held-out ones were off `at first sight`, when nobody had looked at what GCC makes
of them, batch by batch. Then come today's errors of all kernels. Rules have been learnt from many of them, held-out ones
too: `left out` is the error of a kernel without the rules that it alone needs (`bfsim/kernel/rules.py`). Classes: predicted
minus measured operations, in percent of all operations measured.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import mean, median

from rich.console import Console
from rich.table import Table

from benchmarks.twins.cases import CASES
from benchmarks.twins.measured import CLASSES, Measured, Role, by_class, measured
from benchmarks.twins.predicted import predict
from bfsim.kernel import GCC_O0, GCC_O2, CompilerProfile
from bfsim.kernel.rules import GCC, LEARNT_FROM, Rule

PROFILES = {"O0": GCC_O0, "O2": GCC_O2}
NEEDED = 1.0  # a kernel needs a rule that brings it so many percentage points nearer

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
    """One kernel. Errors in percent of the measured cycles, `first_sight` of held-out ones; `classes` in percent of all measured operations."""

    kernel: str
    role: str
    predicted_cycles: int
    measured_cycles: int
    error: float
    error_left_out: float
    first_sight: float | None
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
            first_sight=truth.first_sight.percent[level] if truth.first_sight else None,
            classes=_classes(found.operations, truth.operations[level]),
        )


def _without(kernel: str, profile: CompilerProfile) -> CompilerProfile:
    rules = tuple(rule for rule, kernels in LEARNT_FROM.items() if kernels == (kernel,))
    return dataclasses.replace(profile, without=rules) if rules and profile.optimises else profile


def needing(rule: Rule) -> dict[str, tuple[float, float]]:
    """Return the kernels that are at least NEEDED further off at -O2 without `rule`, with their errors with and without it."""
    found = {}
    profiles = [dataclasses.replace(GCC_O2, without=each) for each in ((), (rule,))]
    for case in CASES:
        with_it, without = (
            _error(predict(case, each).cycles, measured()[case.name], "O2") for each in profiles
        )
        if abs(without) >= abs(with_it) + NEEDED:
            found[case.name] = (with_it, without)
    return found


def print_rules(console: Console) -> None:
    """Print each rule with the kernels that it was learnt from and those that need it."""
    for rule in Rule:
        needed = needing(rule)
        console.print(
            f"{rule.name}: {rule.value}; learnt from {', '.join(LEARNT_FROM[rule])}", highlight=False
        )
        for kernel, (with_it, without) in needed.items():
            console.print(f"    {kernel} {with_it:+.1f} %, without {without:+.1f} %", highlight=False)
        if len(needed) == 1 and tuple(needed) != LEARNT_FROM[rule]:
            console.print("    only this one: it must be what the rule is learnt from", style="bold")


@dataclass(frozen=True, slots=True)
class Worth:
    """What leaving out a rule makes of the mean error at -O2, in percentage points, and how many held-out kernels it brings nearer or farther off."""

    held_out: float
    others: float
    nearer: int
    farther: int


def worth(rule: Rule) -> Worth:
    """Cost all kernels at -O2 with and without `rule`."""
    without = dataclasses.replace(GCC_O2, without=(rule,))
    grows: dict[bool, list[float]] = {True: [], False: []}
    for case in CASES:
        truth = measured()[case.name]
        with_it, left_out = (
            abs(_error(predict(case, each).cycles, truth, "O2")) for each in (GCC_O2, without)
        )
        grows[truth.role is Role.HELD_OUT].append(left_out - with_it)
    held_out = grows[True]
    counts = (sum(sign * each >= NEEDED for each in held_out) for sign in (1, -1))
    return Worth(mean(held_out), mean(grows[False]), *counts)


def print_ablation(console: Console, rules: Sequence[Rule]) -> None:
    """Print what each rule is worth, and where it comes from."""
    table = _new_table("gcc -O2: by how much the mean error grows without a rule, in points", "rule")
    for name in ("held-out", "others", "nearer", "farther"):
        table.add_column(name, justify="right")
    table.add_column("source")
    for rule in rules:
        found = worth(rule)
        points = f"{found.held_out:+.2f}", f"{found.others:+.2f}"
        table.add_row(rule.name, *points, str(found.nearer), str(found.farther), GCC.get(rule, "fitted"))
    console.print(table)


def _error(cycles: int, truth: Measured, level: str) -> float:
    return 100 * (cycles / truth.cycles[level] - 1)


def _classes(predicted: dict[str, int], truth: dict[str, int]) -> dict[str, float]:
    ours, theirs, whole = by_class(predicted), by_class(truth), sum(truth.values())
    return {group: 100 * (ours[group] - theirs[group]) / whole for group in CLASSES}


def summary(rows: Sequence[Comparison], role: Role) -> dict[str, float]:
    """Return mean, median and largest error of the kernels of a role, as they are and left out."""
    errors = [abs(each.error) for each in rows if each.role == role]
    left_out = [abs(each.error_left_out) for each in rows if each.role == role]
    return {
        "kernels": len(errors),
        "mean": mean(errors),
        "median": median(errors),
        "largest": max(errors),
        "mean_left_out": mean(left_out),
        "median_left_out": median(left_out),
        "largest_left_out": max(left_out),
    }


@dataclass(frozen=True, slots=True)
class Batch:
    """Held-out kernels that were first measured together, by the commit of the model; errors in percent, `signed` the mean with signs."""

    commit: str
    kernels: int
    mean: float
    signed: float
    largest: float
    worst: str


def first_sight(level: str) -> list[Batch]:
    """Return how far off the held-out kernels were at first sight: batch by batch as they came, and last all of them."""
    batches: dict[tuple[str, str], dict[str, float]] = {}
    for each in measured().values():
        if first := each.first_sight:
            batches.setdefault((first.at, first.commit), {})[each.name] = first.percent[level]
    found = [_batch(commit, errors) for (_, commit), errors in sorted(batches.items())]
    return [*found, _batch("all", {name: off for errors in batches.values() for name, off in errors.items()})]


def _batch(commit: str, errors: Mapping[str, float]) -> Batch:
    sizes = {name: abs(error) for name, error in errors.items()}
    worst = max(sizes, key=lambda name: sizes[name])
    return Batch(commit, len(sizes), mean(sizes.values()), mean(errors.values()), sizes[worst], worst)


def first_sight_table(batches: Sequence[Batch], level: str) -> Table:
    """Return the errors at first sight."""
    result = _new_table(
        f"gcc -{level}: kernels nobody had looked at, first measured; error of the cycles, %", "batch"
    )
    for name in ("kernels", "mean", "signed", "largest"):
        result.add_column(name, justify="right")
    result.add_column("")
    for each in batches:
        numbers = str(each.kernels), f"{each.mean:.1f}", f"{each.signed:+.1f}", f"{each.largest:.1f}"
        result.add_row(each.commit, *numbers, each.worst, style="bold" if each is batches[-1] else "")
    return result


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


def _new_table(title: str, first: str = "kernel") -> Table:
    result = Table(title=title, title_justify="left", box=None, padding=(0, 1, 0, 0), pad_edge=False)
    result.add_column(first, no_wrap=True)
    return result


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--level", choices=list(PROFILES), default="O2", help="optimisation level of GCC")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    parser.add_argument("--rules", action="store_true", help="print which kernels need each rule")
    parser.add_argument("--ablate", nargs="*", metavar="RULE", help="print what each rule is worth, or these")
    options = parser.parse_args()
    if options.rules:
        print_rules(Console())
        return
    if options.ablate is not None:
        print_ablation(Console(), [Rule[each] for each in options.ablate] or list(Rule))
        return
    rows = list(compare(options.level))
    if options.json:
        sums = {role.value: summary(rows, role) for role in Role}
        print(
            json.dumps(
                {
                    "level": options.level,
                    "first_sight": [dataclasses.asdict(each) for each in first_sight(options.level)],
                    "summary": sums,
                    "kernels": [dataclasses.asdict(each) for each in rows],
                },
                indent=2,
            )
        )
        return
    console = Console()
    console.print(first_sight_table(first_sight(options.level), options.level))
    console.print(cycle_table(rows, options.level))
    console.print(class_table(rows, options.level))
    for role in Role:
        sums = summary(rows, role)
        today, left_out = (
            ", ".join(f"{name} {sums[name + ending]:.1f}" for name in ("mean", "median", "largest"))
            for ending in ("", "_left_out")
        )
        console.print(f"{role.value}, %: today {today}")
        console.print(f"    left out {left_out}")


if __name__ == "__main__":
    main()
