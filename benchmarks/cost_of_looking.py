"""What it costs to look: a profile, JSON, a trace, a flame graph, pictures and a page beside the plain run, in processor time and memory.

    python benchmarks/cost_of_looking.py
    python benchmarks/cost_of_looking.py --frames 8 --pairs 9
    python benchmarks/cost_of_looking.py --against ../older

Each command runs in a process of its own, in turns with the plain run just before it, so that both find the machine as it is; a
figure is the median of the ratios of such pairs, with the smallest and the largest. Issue 14 asks for at most 1.3 times
a run for a profile and 2.5 for a trace. `--against` is another checkout of bfsim, such as one from before owners were recorded:
its plain run is then what the plain run of this one is compared with.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.table import Table

HERE = Path(__file__).parents[1]
AIMS: Mapping[str, float] = {"profile": 1.3, "run --trace": 2.5}
"""At most so many times the plain run, in processor time."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Processor time of a process, its children's too, and the most memory that it had."""

    seconds: float
    mb: float


def cost_of(command: Sequence[str], root: Path) -> Cost:
    """Run bfsim of the checkout at `root` in a process."""
    paths = os.pathsep.join((str(root), str(root / "firmware")))
    line = [sys.executable, "-m", "bfsim", *command]
    with subprocess.Popen(
        line, env={**os.environ, "PYTHONPATH": paths}, stdout=subprocess.DEVNULL
    ) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(line)} ended with {process.returncode}")
    return _cost(used)


def _cost(used: resource.struct_rusage) -> Cost:
    return Cost(seconds=used.ru_utime + used.ru_stime, mb=used.ru_maxrss / 1024)


def pairs_of(
    plain: tuple[Sequence[str], Path], other: tuple[Sequence[str], Path], pairs: int
) -> Iterator[tuple[Cost, Cost]]:
    """Yield the costs of both, one after the other; which one comes first changes from pair to pair."""
    cost_of(*plain), cost_of(*other)  # all is compiled then
    for number in range(pairs):
        if number % 2:
            second = cost_of(*other)
            yield cost_of(*plain), second
        else:
            first = cost_of(*plain)
            yield first, cost_of(*other)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--frames", type=int, default=8, help="of the built-in recording (default: %(default)s)"
    )
    parser.add_argument("--pairs", type=int, default=5, help="runs of each (default: %(default)s)")
    parser.add_argument("--recording", help="another recording")
    parser.add_argument("--against", type=Path, help="a checkout whose plain run this one's is compared with")
    given = parser.parse_args()
    what = [*([given.recording] if given.recording else []), "--frames", str(given.frames)]
    plain = ["run", *what], HERE
    with tempfile.TemporaryDirectory() as folder:
        cases = {
            "profile": (["profile", *what], HERE),
            "run --json": (["run", *what, "--json", f"{folder}/run.json"], HERE),
            "run --trace": (["run", *what, "--trace", f"{folder}/run.pftrace"], HERE),
            "run --flame": (["run", *what, "--flame", f"{folder}/run.speedscope.json"], HERE),
            "run --overlay": (["run", *what, "--overlay", f"{folder}/overlay"], HERE),
            "run --html": (["run", *what, "--html", f"{folder}/run.html"], HERE),
        }
        if given.against:
            cases = {"run": plain}
            plain = ["run", *what], given.against.resolve()
        table = Table("Command", "times a run", "least", "most", "at most", "s", "s of the run", "MB more")
        for name, case in cases.items():
            pairs = list(pairs_of(plain, case, given.pairs))
            ratios = sorted(looked.seconds / ran.seconds for ran, looked in pairs)
            table.add_row(
                name,
                *(f"{each:.2f}" for each in (median(ratios), ratios[0], ratios[-1])),
                f"{AIMS[name]:.1f}" if name in AIMS else "",
                f"{median(looked.seconds for _, looked in pairs):.2f}",
                f"{median(ran.seconds for ran, _ in pairs):.2f}",
                f"{median(looked.mb - ran.mb for ran, looked in pairs):.0f}",
            )
        Console().print(table)


if __name__ == "__main__":
    main()
