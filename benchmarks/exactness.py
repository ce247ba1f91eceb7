"""Compare the cycles of translated object code with the GNU simulator's, call by call: every difference is a mistake of bfsim.

    python -m benchmarks.exactness firmware       the built-in firmware's kernels, calls of two frames
    python -m benchmarks.exactness twins          the kernels of `benchmarks/twins` and `benchmarks/firmware_twins`
    python -m benchmarks.exactness random 1000    so many random kernels

Each set is compiled at -O2 and -O0 from the C that `bfsim export` writes; the hand-written C of the firmware's twins,
too, in each of its variants. Needs a bfin-elf toolchain on PATH; takes a minute, a minute, and a minute for each 150
random kernels and level.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

from benchmarks.firmware_twins.measure import SOURCES as WRITTEN
from benchmarks.firmware_twins.measure import VARIANTS, options_of
from benchmarks.firmware_twins.recorded import recorded
from benchmarks.firmware_twins.twins import TWINS
from benchmarks.twins.cases import CASES
from benchmarks.twins.exported import calls_of
from bfsim.compiling.object_code import ObjectCode, object_code
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.kernel import GCC_O0, GCC_O2, Kernel
from bfsim.kernel.language.tree import first_float
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernels import kernels_of
from bfsim.run import simulate
from bfsim.verifying import Sampler
from bfsim.verifying.played import simulated, translated
from bfsim.verifying.sample import Argument, Sample
from tests.kernel.modules import import_text
from tests.kernel.plain import arrays_of
from tests.kernel.programs import programs

Set = tuple[str, Sampler, ObjectCode]
LEVELS = (GCC_O2, GCC_O0)
CALLS = 16
BATCH = 50
"""Random kernels in one file: compilers take long for a thousand, and a file of one is not how C is written."""
CALLS_OF_RANDOM = 3


def firmware() -> Iterator[Set]:
    """Calls of two frames."""
    sampler = Sampler(CALLS)
    simulate(frames=2, on_call=sampler.see)
    kernels = kernels_of(load_firmware("tinyphoon").own) | set(sampler.of)
    yield from _at_all_levels("firmware", sampler, kernels)


def twins() -> Iterator[Set]:
    """The calls of each case, and those of the recorded run by hand-written C."""
    cases = {each.kernel: Sample(kept=calls_of(each)[0][:CALLS]) for each in CASES}
    yield from _at_all_levels("twins", Sampler(CALLS, cases), set(cases))
    sample = {each: Sample(kept=list(recorded()[each].arguments)) for each in TWINS}
    toolchain, names = blackfin_toolchain(), {each.function: each.name for each in TWINS}
    with tempfile.TemporaryDirectory() as name:
        for variant in VARIANTS:
            if not VARIANTS[variant].one_file:
                sources = [str(each) for each in sorted(WRITTEN.glob("*.c"))]
                made = toolchain.build_object(Path(name), sources, options_of(variant)).read_bytes()
                code = ObjectCode(made, toolchain.identity.version, names, is_shipped=False)
                yield f"firmware twins by hand, {variant}", Sampler(CALLS, sample), code


def random(count: int) -> Iterator[Set]:
    """Kernels as `tests/kernel/programs.py` draws them, each called with three sets of arguments."""
    with tempfile.TemporaryDirectory() as name:
        kernels = [import_text(each, Path(name)).program for each in _texts(count)]
        for first in range(0, count, BATCH):
            batch = kernels[first : first + BATCH]
            calls = {each: Sample(kept=list(_arguments(first + at))) for at, each in enumerate(batch)}
            yield from _at_all_levels(
                f"random {first + 1} to {first + len(batch)}", Sampler(CALLS, calls), set(batch)
            )


def _at_all_levels(name: str, sampler: Sampler, kernels: set[Kernel]) -> Iterator[Set]:
    for profile in LEVELS:
        ours = {
            each: sample for each, sample in sampler.of.items() if profile.floats or not _has_floats(each)
        }
        code = object_code(kernels, ours, profile, blackfin_toolchain())
        yield f"{name}, {profile.name}", Sampler(CALLS, ours), code


def _has_floats(kernel: Kernel) -> bool:
    return any(first_float(each) for each in (kernel.function, *kernel.function.callees()))


def _texts(count: int) -> list[str]:
    """Programs, the same in each run."""
    found: list[str] = []

    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @seed(16)
    @given(programs())
    def draw(text: str) -> None:
        found.append(text)

    draw()
    return found[:count]


def _arguments(number: int) -> Iterator[tuple[Argument, ...]]:
    generator = np.random.default_rng(number)
    for call in range(CALLS_OF_RANDOM):
        x, y = int(generator.integers(-(2**31), 2**31)), int(generator.integers(2**32))
        yield (*arrays_of(number + call).values(), x >> generator.integers(32), y >> generator.integers(32))


def main() -> None:
    """Print what was compared, set by set."""
    sets = {"firmware": firmware, "twins": twins, "random": lambda: random(given.count)}
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=list(sets))
    parser.add_argument("count", type=int, nargs="?", default=1000, help="of random kernels (default: 1000)")
    given = parser.parse_args()
    kernels = calls = cycles = bits = 0
    for name, sampler, code in sets[given.what]():
        ours, judge = translated(sampler, code), simulated(sampler, code, blackfin_toolchain())
        pairs = [both for each in sampler.of for both in zip(ours[each], judge[each], strict=True)]
        other_cycles = sum(one.cclk != other.cclk for one, other in pairs)
        other_bits = sum(one.checksum != other.checksum for one, other in pairs)
        print(
            f"{name}: {len(sampler.of)} kernels, {len(pairs)} calls, {sum(judged.cclk for _, judged in pairs):,} cycles; "
            f"other cycles in {other_cycles}, other bits in {other_bits}",
            flush=True,
        )
        kernels, calls = kernels + len(sampler.of), calls + len(pairs)
        cycles, bits = cycles + other_cycles, bits + other_bits
    print(f"all: {kernels} kernels, {calls} calls; other cycles in {cycles}, other bits in {bits}")


if __name__ == "__main__":
    main()
