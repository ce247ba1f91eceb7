"""Compile what comes with bfsim: the kernels of the built-in firmware, which are kept as C, too, and the examples of the documentation.

    python -m benchmarks.toolchain.keep

It needs GCC 12.2.0 for the Blackfin on the PATH, and writes to `bfsim/compiling/kept`; what is there and no longer used
is removed. After a change of a kernel of the built-in firmware it must be run again, or `bfsim verify` needs a
compiler.
"""

from __future__ import annotations

import argparse
import json
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import asdict

from bfsim.compiling.file_code import SOURCES, recipe_of_source
from bfsim.compiling.first_calls import FIRST_CALLS
from bfsim.compiling.object_code import LEVELS, PROGRAMS, InC, recipe_of, written
from bfsim.compiling.recipes import KEPT_COMPILER, Recipe
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.files.store import KEPT
from bfsim.kernel import Kernel
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernels import entries_of, kernels_of
from bfsim.machine.memories import Row
from bfsim.run import simulate
from bfsim.shipped import FIRMWARE
from tests.pages import PAGES, ROOT, blocks_of

FOLDER = ROOT / "bfsim" / "compiling" / KEPT


def programs() -> dict[str, InC]:
    """Write the built-in firmware as C. Returns it under the names under which it is kept."""
    found = [load_firmware(each) for each in FIRMWARE]
    entries = [entries_of(each.firmware) for each in found]
    return dict(
        written(kernels_of(each.own) | called, called) for each, called in zip(found, entries, strict=True)
    )


def recipes(programs: Iterable[InC]) -> Iterator[Recipe]:
    """Yield what is compiled and kept."""
    for program in programs:
        for level in dict.fromkeys(LEVELS.values()):
            yield recipe_of(program.files, level)
    for page in PAGES:
        for each in blocks_of(page):
            if each.title.endswith(SOURCES):
                yield recipe_of_source({each.title: each.text.encode()}, each.title)


def first_calls() -> str:
    """Run the built-in firmware of two cores on the built-in recording. Returns which kernels are called first, as `in_order` reads it."""
    found: dict[str, list[str]] = {}

    def note(kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
        found.setdefault(kernel.function.symbol, [each.buffer for each in arguments if isinstance(each, Row)])

    for each in FIRMWARE:
        if len(load_firmware(each).firmware.mains) > 1:  # the kernels of one core alone are the same
            simulate(firmware=each, on_call=note)
    return "\n".join(" ".join((symbol, *buffers)) for symbol, buffers in found.items())


def main() -> None:
    """Compile and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    toolchain = blackfin_toolchain()
    assert toolchain.identity == KEPT_COMPILER, toolchain.identity
    FOLDER.mkdir(exist_ok=True)
    in_c = programs()
    wanted = {each.digest(KEPT_COMPILER): each for each in recipes(in_c.values())}
    (FOLDER / FIRST_CALLS).write_bytes(zlib.compress(first_calls().encode(), 9))
    for old in {each.name for each in FOLDER.iterdir()} - wanted.keys() - {FIRST_CALLS}:
        (FOLDER / old).unlink()
    (FOLDER / PROGRAMS).write_bytes(zlib.compress("\n".join(in_c).encode(), 9))
    for name, program in in_c.items():
        (FOLDER / name).write_bytes(zlib.compress(json.dumps(asdict(program)).encode(), 9))
    for name, each in wanted.items():
        if not (FOLDER / name).exists():
            (FOLDER / name).write_bytes(zlib.compress(each.made(toolchain), 9))
        print(f"{name[:12]}  {(FOLDER / name).stat().st_size:7,} bytes  {', '.join(each.sources)[:60]}")


if __name__ == "__main__":
    main()
