"""Where the time of a frame goes: the simulator's own, in µs by part, as docs/speed.md has it.

    python benchmarks/frame_time.py [--frames 48] [--profile gcc-adi]

Compiled code is timed at each call; what Python does between is sampled each millisecond of processor time, in a run of its
own. Compare the parts with each other: all of them are as fast as the machine is just then.
"""

from __future__ import annotations

import argparse
import signal
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache, partial
from itertools import cycle, islice
from pathlib import Path
from time import process_time
from types import FrameType

import simpy

import bfsim
import tinyphoon
from benchmarks.native_time import Stopwatch, native_time
from bfsim.api import FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.kernel import VDSP_O2
from bfsim.kernel.build import ESTIMATED, Build
from bfsim.kernel.profile import profile_named
from bfsim.linker import link, parse_ldf
from bfsim.loading.firmware import LoadedFirmware, load_firmware
from bfsim.machine.board import Board
from bfsim.machine.symbols import symbols_of
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.running.building import build_for
from bfsim.shipped import DEFAULT_LDFS, FIRMWARE, RECORDING

INTERVAL_S = 0.001
SIMULATOR = Path(bfsim.__file__).parent
KERNELS, WEAVE = "calls of kernels, as far as Python makes them", "buses, machine code and Python"
MAIN_LOOPS = "main loops and stages of the firmware, calls of kernels, and lines of rings"
PARTS = {
    Path(tinyphoon.__file__).parent: MAIN_LOOPS,
    SIMULATOR / "kernel": KERNELS,
    SIMULATOR / "blackfin": KERNELS,
    SIMULATOR / "machine" / "calls": KERNELS,
    SIMULATOR / "machine" / "core" / "tasks" / "tasks.py": KERNELS,
    SIMULATOR / "machine" / "bus": WEAVE,
    SIMULATOR / "machine" / "dma": "rings and DMA, as far as Python makes them",
    SIMULATOR / "machine" / "core": "clocks of the cores, and what runs ahead",
    SIMULATOR / "machine": "the rest of the machine",
    Path(simpy.__file__).parent: "SimPy",
}
"""What the Python in a folder or a file is a part of, the first that fits."""
REST = "everything else"


def frames_of(number: int) -> list[StereoFrame]:
    """The built-in recording over and over."""
    with RecordingReader(RECORDING) as reader:
        return list(islice(cycle(list(reader.frames())), number))


@cache
def loaded() -> LoadedFirmware:
    """The built-in firmware, as `bfsim run` has it."""
    return load_firmware(FIRMWARE[0])


def build_of(profile: str) -> Build:
    """Return how `bfsim run --profile` builds its kernels."""
    with loaded().own.named():
        return build_for(loaded(), profile_named(profile))


def board_of(build: Build) -> Board:
    """Return a board with the built-in firmware."""
    size, firmware = FrameSize(320, 240), loaded().firmware
    with loaded().own.named():
        link_map = link(parse_ldf(DEFAULT_LDFS["ADSP-BF561"]), symbols_of(firmware, size, build))
        return Board(CM_BF561, firmware, size, link_map, build=build)


def run(
    frames: Sequence[StereoFrame],
    build: Build = ESTIMATED,
    watched: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> float:
    """Run the built-in firmware on a board that was made before, in a context that watches; return the processor time, in seconds."""
    board = board_of(build)
    with loaded().own.named(), watched():
        begin = process_time()
        board.run(iter(frames))
        return process_time() - begin


@contextmanager
def sampled(parts: Counter[str]) -> Iterator[None]:
    """Count each millisecond of processor time for the part whose Python is at work, or has called compiled code."""

    @cache
    def part_of(file: str) -> str:
        return next((part for folder, part in PARTS.items() if Path(file).is_relative_to(folder)), REST)

    def sample(_: int, frame: FrameType | None) -> None:
        parts[part_of(frame.f_code.co_filename) if frame else REST] += 1

    before = signal.signal(signal.SIGPROF, sample)
    signal.setitimer(signal.ITIMER_PROF, INTERVAL_S, INTERVAL_S)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)
    signal.signal(signal.SIGPROF, before)


def measure(number: int, build: Build) -> dict[str, float]:
    """Return the time of each part, in µs a frame: Python's by its share of the samples, without the compiled code it calls."""
    frames = frames_of(number)
    run(frames, build)  # compiles
    kernels = Stopwatch()
    with native_time(kernels, Stopwatch()):
        run(frames, build)
    samples = Counter[str]()
    whole = run(frames, build, partial(sampled, samples))
    native = {MAIN_LOOPS: kernels.seconds}  # of the buses Python has less than a sample's error
    parts = {
        part: whole * count / samples.total() - native.get(part, 0) for part, count in samples.most_common()
    }
    named = {"kernels, machine code": kernels.seconds} | parts
    return {part: seconds * 1e6 / number for part, seconds in named.items()} | {
        "a frame": whole * 1e6 / number
    }


def main() -> None:
    """Print the table, as Markdown."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=48, help="how many (default: 48)")
    parser.add_argument("--profile", default=VDSP_O2.name, help=f"compiler profile (default: {VDSP_O2.name})")
    given = parser.parse_args()
    print("| part | µs |\n|---|---|")
    for part, us in measure(given.frames, build_of(given.profile)).items():
        print(f"| {part} | {us:,.0f} |")


if __name__ == "__main__":
    main()
