"""What a sweep of 8 configurations costs in time and memory: processes of this machine, a Dask cluster on it, and re-timing.

Processes with re-timing play what they can from a recorded run, as `bfsim sweep` does; without, and on the cluster, all runs.

    python benchmarks/sweeps.py [--frames 1000] [--json]

With 1000 frames that takes a quarter of an hour on two cores. The frames are those of the built-in recording over and over; the
configurations two placements times two clocks times two SDRAM timings. Each way runs in a process of its own, with as many
workers. CPU seconds are those of all processes together: they say what it costs on a machine that is busy with other things, too.
"""

from __future__ import annotations

import argparse
import json
import logging
import os
import resource
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from itertools import cycle, islice
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

from bfsim.recording import RecordingReader
from bfsim.recording.writer import RecordingWriter
from bfsim.report.check.baseline import Configuration
from bfsim.shipped import RECORDING
from bfsim.sweeping.cluster import Cluster
from bfsim.sweeping.planned import Planned
from bfsim.sweeping.running import Outcome, Work, code_digest
from bfsim.sweeping.store import Store
from bfsim.sweeping.sweep import Sweep, Workers
from bfsim.sweeping.workers import Pool

PERIOD_NS = 40_000_000
Figures = dict[str, float]
COLUMNS = {
    "s": "whole_s",
    "of it checks, s": "checked_s",
    "all runs, s": "runs_s",
    "CPU s": "cpu_s",
    "MB a worker": "largest_worker_mb",
}
FILE = """\
base.recording = "long.mcap"
[axes]
ldf = ["thesis", "l2"]
set.clocks.cclk_hz = [600e6, 500e6]
set.sdram.nRP = [2, 4]
"""


def record(path: Path, frames: int) -> None:
    """Write a recording of so many frames."""
    with RecordingReader(RECORDING) as reader:
        pictures = list(reader.frames())
        with RecordingWriter(path, width=reader.width, height=reader.height) as writer:
            for number, frame in enumerate(islice(cycle(pictures), frames)):
                writer.add(frame.left, frame.right, number * PERIOD_NS, number * PERIOD_NS)


class PlainPool(Pool):
    """Processes that never record, and never play."""

    def run_point(
        self,
        configuration: Configuration,
        folder: Path,
        code: str,
        work: Work | None,
    ) -> Future[Outcome]:
        """Run it."""
        return super().run_point(configuration, folder, code, None)


@contextmanager
def dask(workers: int) -> Iterator[Workers]:
    """Yield the workers of a cluster on this machine."""
    import distributed

    warnings.simplefilter("ignore")
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        ) as cluster,
        Cluster(cluster.scheduler_address, code_digest()) as ours,
    ):
        yield ours


WAYS: dict[str, Callable[[int], object]] = {"pool": PlainPool, "Dask": dask, "re-timing": Pool}


def sweep_in(folder: Path, way: str, workers: int) -> dict[str, float]:
    """Sweep in one way; seconds of the whole, of all runs together, and MB of the largest process."""
    file = folder / "sweep.toml"
    file.write_text(FILE)
    began = perf_counter()
    seconds: list[float] = []

    def tell(_planned: Planned, outcome: Outcome) -> None:
        assert not outcome.error, outcome.error
        seconds.append(outcome.seconds)

    with WAYS[way](workers) as crew:  # type: ignore[attr-defined]
        sweep = Sweep(file, Store(folder / way))
        sweep.plan(crew, lambda _done, _all: None)
        planned_s = perf_counter() - began
        sweep.run(crew, tell)
    own, others = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "points": len(seconds),
        "whole_s": perf_counter() - began,
        "checked_s": planned_s,
        "runs_s": sum(seconds),
        "cpu_s": sum(each.ru_utime + each.ru_stime for each in (own, others)),
        "largest_worker_mb": others.ru_maxrss / 1000,  # the system counts in kilobytes
    }


def main() -> None:
    """Measure each way, and print them beside each other."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=1000, metavar="N")
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--in", dest="folder", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--way", choices=WAYS, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.way:
        sys.stdout.write(json.dumps(sweep_in(given.folder, given.way, given.workers)))
        return
    found = measured_all(given.frames, given.workers)
    if given.json:
        print(json.dumps({"workers": given.workers, "frames": given.frames, "ways": found}, indent=2))
    else:
        print_table(f"{given.frames} frames x 8 configurations, {given.workers} workers", found)


def measured_all(frames: int, workers: int) -> dict[str, Figures]:
    """Sweep a recording of so many frames in each way."""
    with tempfile.TemporaryDirectory() as folder:
        record(Path(folder) / "long.mcap", frames)
        return {way: measured(way, folder, workers) for way in WAYS}


def print_table(title: str, ways: Mapping[str, Figures]) -> None:
    """Print the ways beside each other."""
    table = Table(title=title, title_justify="left")
    for head in ("way", *COLUMNS):
        table.add_column(head, justify="left" if head == "way" else "right")
    for way, each in ways.items():
        table.add_row(way, *(f"{each[name]:.1f}" for name in COLUMNS.values()))
    Console().print(table)


def measured(way: str, folder: str, workers: int) -> dict[str, float]:
    """Sweep in a process of its own."""
    command = [
        sys.executable,
        "-m",
        "benchmarks.sweeps",
        "--way",
        way,
        "--in",
        folder,
        "--workers",
        str(workers),
    ]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE)
    found: dict[str, float] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    main()
