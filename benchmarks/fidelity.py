"""How far the fast mode is from the detailed one, and how much faster: frames and stages, side by side in one run.

    python benchmarks/fidelity.py
    python benchmarks/fidelity.py --frames 4 --seeds 10
    python benchmarks/fidelity.py --json

The built-in recording in every placement of ldf/ that links, and random traffic (`random_traffic.py`), which no
firmware would want to be. Per core: milliseconds a frame, and the largest difference of any frame.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from statistics import fmean
from time import perf_counter

from rich.console import Console
from rich.table import Table

from benchmarks.random_traffic import SIZE, hammer, pictures
from bfsim.api import Firmware, FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.errors import BfsimError
from bfsim.linker import LinkMap, link, parse_ldf
from bfsim.machine.board import Board, Fidelity
from bfsim.machine.symbols import symbols_of
from bfsim.recording import RecordingReader
from bfsim.shipped import DEFAULT_LDFS, LDF_FOLDER, RECORDING
from bfsim.trace import REST, BoardRecord
from tinyphoon import tinyphoon

# the aims
MOST_FRAME_PERCENT, MOST_STAGE_PERCENT, LEAST_RATIO = 2, 5, 20
FRAME = "Frame"


@dataclass(frozen=True, slots=True)
class Row:
    """One stage on one core, over all frames. `percent`: mean of detailed against fast; `largest`: of any frame."""

    stage: str
    core: str
    fast_ms: float
    detailed_ms: float
    percent: float
    largest: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """One case in both modes, and the seconds that each took."""

    case: str
    rows: tuple[Row, ...]
    fast_s: float
    detailed_s: float


def cycles_of(outcome: BoardRecord) -> dict[tuple[str, str], list[int]]:
    """Return the cycles of each frame by stage and core. A frame is all but the idle cycles.

    What belongs to no stage counts in the frame only.
    """
    found: dict[tuple[str, str], list[int]] = {}
    for core in (each for frame in outcome.frames for each in frame.cores):
        for stage in core.stages:
            if stage.stage != REST and stage.elapsed_cclk:
                found.setdefault((stage.stage, core.core), []).append(stage.elapsed_cclk)
        found.setdefault((FRAME, core.core), []).append(
            sum(each.elapsed_cclk - each.idle_cclk for each in core.stages)
        )
    return found


def rows_of(fast: BoardRecord, detailed: BoardRecord, cclk_hz: float) -> Iterator[Row]:
    """Compare two outcomes of the same frames."""
    theirs = cycles_of(detailed)
    for (stage, core), ours in cycles_of(fast).items():
        judged = theirs[stage, core]
        yield Row(
            stage=stage,
            core=core,
            fast_ms=1000 * fmean(ours) / cclk_hz,
            detailed_ms=1000 * fmean(judged) / cclk_hz,
            percent=100 * (sum(judged) / sum(ours) - 1),
            largest=max((100 * (b / a - 1) for a, b in zip(ours, judged, strict=True)), key=abs),
        )


def compare(case: str, run: Callable[[Fidelity], BoardRecord]) -> Comparison:
    """Run a case in both modes, once before to have every kernel compiled."""
    run(Fidelity.FAST)
    began = perf_counter()
    fast = run(Fidelity.FAST)
    between = perf_counter()
    detailed = run(Fidelity.DETAILED)
    ended = perf_counter()
    rows = tuple(rows_of(fast, detailed, float(CM_BF561.clocks.cclk_hz)))
    return Comparison(case, rows, between - began, ended - between)


def board_of(program: Firmware, size: FrameSize, places: LinkMap, fidelity: Fidelity) -> Board:
    """Put firmware on the board."""
    return Board(CM_BF561, program, size, places, fidelity=fidelity)


def recordings(frames: int) -> Iterator[Comparison]:
    """Compare on the built-in recording, placement by placement."""
    with RecordingReader(RECORDING) as reader:
        size, taken = FrameSize(reader.width, reader.height), list(islice(reader.frames(), frames))
    symbols = symbols_of(tinyphoon, size)
    for path in sorted(LDF_FOLDER.glob("*.ldf")):
        try:
            places = link(parse_ldf(path), symbols, CM_BF561.chip.regions)
        except BfsimError:  # of another chip, or a part that others include
            continue
        yield compare(
            path.name, lambda mode, places=places: board_of(tinyphoon, size, places, mode).run(iter(taken))
        )


def random_traffic(frames: int, seeds: int) -> Iterator[Comparison]:
    """Compare on random traffic, seed by seed."""
    script = parse_ldf(DEFAULT_LDFS["ADSP-BF561"])
    for seed in range(seeds):
        places = link(script, symbols_of(hammer(seed), SIZE), CM_BF561.chip.regions)
        yield compare(
            f"random {seed}",
            lambda mode, seed=seed, places=places: board_of(hammer(seed), SIZE, places, mode).run(
                pictures(frames, seed)
            ),
        )


def table_of(comparison: Comparison) -> Table:
    """Return a case as a table."""
    ratio = comparison.detailed_s / comparison.fast_s
    title = f"{comparison.case}: {comparison.fast_s:.3f} s fast, {comparison.detailed_s:.1f} s detailed, {ratio:.0f}x"
    table = Table("Stage", "Core", title=title, title_justify="left")
    for name in ("fast ms", "detailed ms", "difference %", "largest %"):
        table.add_column(name, justify="right")
    for row in comparison.rows:
        table.add_row(
            row.stage,
            row.core,
            f"{row.fast_ms:.4f}",
            f"{row.detailed_ms:.4f}",
            f"{row.percent:+.3f}",
            f"{row.largest:+.3f}",
        )
    return table


def verdicts(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Say how the differences and the speed stand against the aims."""
    rows = [row for each in comparisons for row in each.rows]
    frames = [abs(row.largest) for row in rows if row.stage == FRAME]
    stages = [abs(row.largest) for row in rows if row.stage != FRAME]
    for name, found, most in (("frame", frames, MOST_FRAME_PERCENT), ("stage", stages, MOST_STAGE_PERCENT)):
        yield f"{name}: largest {max(found):.3f} %, mean {fmean(found):.3f} %; aim {most} % at most"
    least = min(each.detailed_s / each.fast_s for each in comparisons)
    yield f"fast is {least:.0f} times faster at least; aim {LEAST_RATIO}"


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--frames", type=int, default=2, help="stereo frames of each case")
    parser.add_argument("--seeds", type=int, default=5, help="cases of random traffic")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    kinds = {
        "Recordings": recordings(chosen.frames),
        "Random traffic": random_traffic(chosen.frames, chosen.seeds),
    }
    if chosen.json:
        print(json.dumps([dataclasses.asdict(each) for each in chain(*kinds.values())], indent=1))
        return
    console = Console()
    for kind, comparisons in kinds.items():
        done = []
        for each in comparisons:  # minutes pass between them
            console.print(table_of(each))
            done.append(each)
        for line in verdicts(done) if done else ():
            console.print(f"{kind}, {line}")


if __name__ == "__main__":
    main()
