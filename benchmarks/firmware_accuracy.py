"""How near the cost model is to GCC's code on the firmware's own kernels, and what that makes of a frame.

    python benchmarks/firmware_accuracy.py             -O2, with calls and with inlining
    python benchmarks/firmware_accuracy.py --level O0
    python benchmarks/firmware_accuracy.py --json

The kernels that make up 98 % of a frame stand in `firmware_twins/c/` once more, as C. Both are run on the same calls, a
sample of those of the built-in recording, and leave the same bits. Measured: GCC 12.2 and the GNU simulator 13.1, in
variants: `inlined`, where GCC inlines and clones within a file of the firmware; `calls`, where every kernel is called;
`one file`, where each kernel stands in one file with all that it calls. Each is compared with the profile that inlines as
much. Of the frame there are two errors: `signed`,
where one kernel's makes up for another's, and `by share`, where it does not.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from rich.console import Console
from rich.table import Table

from benchmarks.firmware_twins.measured import measured
from benchmarks.firmware_twins.recorded import recorded
from benchmarks.firmware_twins.twins import TWINS, frame_cycles, predict
from bfsim.kernel import GCC_O0, GCC_O2
from bfsim.kernel.profile import Inlines

PROFILES = {"O2": GCC_O2, "O0": GCC_O0}
VARIANTS = {
    "O2": {"inlined": Inlines.FILE, "calls": Inlines.NOTHING, "one_file": Inlines.PROGRAM},
    "O0": {"O0": Inlines.NOTHING},
}
"""By level: what each variant may inline. The first one is the profile's own."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One kernel: cycles of a stereo frame, both cores, as predicted and as measured in each variant."""

    kernel: str
    predicted: Mapping[str, float]
    measured: Mapping[str, float]

    @property
    def cycles(self) -> float:
        """Predicted cycles of the profile itself."""
        return next(iter(self.predicted.values()))

    def error(self, variant: str) -> float:
        """Return by how much the prediction is off, in percent of what was measured."""
        return 100 * (self.predicted[variant] / self.measured[variant] - 1)


@dataclass(frozen=True, slots=True)
class FrameError:
    """The errors of all kernels together, in percent of what was measured."""

    signed: float
    by_share: float


@cache
def compare(level: str) -> list[Comparison]:
    """Compare every twin, the one with the greatest share first. Raises ValueError where the outputs are not the same."""
    rows = []
    for kernel in TWINS:
        calls, truth = recorded()[kernel], measured()[kernel.name]
        weight = calls.per_frame / len(calls.arguments)
        found = {}
        for variant, inlines in VARIANTS[level].items():
            profile = dataclasses.replace(PROFILES[level], inlines=inlines)
            prediction = predict(kernel, calls, profile)
            if prediction.checksum != truth.checksum:
                raise ValueError(
                    f"{kernel.name} must leave {truth.checksum} as its C twin did when it was measured, not "
                    f"{prediction.checksum}; change the twin as the kernel was changed, and measure it again"
                )
            found[variant] = weight * sum(prediction.cycles)
        cycles = {variant: weight * sum(truth.cycles[variant]) for variant in VARIANTS[level]}
        rows.append(Comparison(kernel.name, found, cycles))
    return sorted(rows, key=lambda row: -row.cycles)


def frame_error(rows: Sequence[Comparison], variant: str) -> FrameError:
    """Add up the kernels to a frame."""
    whole = sum(row.measured[variant] for row in rows)
    off = [row.predicted[variant] - row.measured[variant] for row in rows]
    return FrameError(100 * sum(off) / whole, 100 * sum(map(abs, off)) / whole)


def covered(rows: Sequence[Comparison], level: str) -> float:
    """Return which part of the frame's predicted cycles the twins are, in percent."""
    return 100 * sum(row.cycles for row in rows) / sum(frame_cycles(PROFILES[level]).values())


def table(rows: Sequence[Comparison], level: str) -> Table:
    """Return shares, cycles and errors."""
    result = Table(
        title=f"gcc -{level}: cycles of a stereo frame, both cores", title_justify="left", box=None,
        padding=(0, 1, 0, 0), pad_edge=False,
    )  # fmt: skip
    result.add_column("kernel", no_wrap=True)
    for head in ("share %", "predicted", *(f"{each.replace('_', ' ')} %" for each in VARIANTS[level])):
        result.add_column(head, justify="right")
    whole = sum(row.cycles for row in rows)
    for row in rows:
        errors = (f"{row.error(variant):+.1f}" for variant in VARIANTS[level])
        result.add_row(row.kernel, f"{100 * row.cycles / whole:.2f}", f"{row.cycles:,.0f}", *errors)
    found = [frame_error(rows, variant) for variant in VARIANTS[level]]
    result.add_section()
    result.add_row("frame, signed", "100.00", f"{whole:,.0f}", *(f"{each.signed:+.1f}" for each in found))
    result.add_row("frame, by share", "", "", *(f"{each.by_share:.1f}" for each in found))
    return result


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--level", choices=list(PROFILES), default="O2", help="optimisation level of GCC")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    options = parser.parse_args()
    rows = compare(options.level)
    if options.json:
        frame = {each: dataclasses.asdict(frame_error(rows, each)) for each in VARIANTS[options.level]}
        kernels = [dataclasses.asdict(row) for row in rows]
        print(json.dumps({"level": options.level, "frame": frame, "kernels": kernels}, indent=2))
        return
    console = Console()
    console.print(table(rows, options.level))
    console.print(f"The twins are {covered(rows, options.level):.1f} % of the frame's issue cycles.")


if __name__ == "__main__":
    main()
