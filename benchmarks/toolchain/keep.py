"""Compile what comes with bfsim: the kernels of the built-in firmware, and the examples of the documentation.

    python -m benchmarks.toolchain.keep

It needs GCC 12.2.0 for the Blackfin on the PATH, and writes to `bfsim/compiling/kept`; what is there and no longer used is removed.
After a change of a kernel of the built-in firmware it must be run again, or `bfsim verify` needs a compiler.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from bfsim.compiling.file_code import SOURCES, recipe_of_source
from bfsim.compiling.object_code import LEVELS, recipe_of
from bfsim.compiling.recipes import KEPT_COMPILER, Recipe
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.kernel import profile_named
from bfsim.loading import entries_of, kernels_of, load_firmware
from bfsim.shipped import FIRMWARE
from bfsim.store import KEPT
from tests.pages import PAGES, ROOT, blocks_of

FOLDER = ROOT / "bfsim" / "compiling" / KEPT


def recipes() -> Iterator[Recipe]:
    """Yield what is kept."""
    for name in FIRMWARE:
        loaded = load_firmware(name)
        entries = entries_of(loaded.firmware)
        for profile in map(profile_named, LEVELS):
            yield recipe_of(kernels_of(loaded.own) | entries, entries, profile)
    for page in PAGES:
        for each in blocks_of(page):
            if each.title.endswith(SOURCES):
                yield recipe_of_source({each.title: each.text.encode()}, each.title)


def main() -> None:
    """Compile and write."""
    toolchain = blackfin_toolchain()
    assert toolchain.identity == KEPT_COMPILER, toolchain.identity
    FOLDER.mkdir(exist_ok=True)
    wanted = {each.digest(KEPT_COMPILER): each for each in recipes()}
    for old in {each.name for each in FOLDER.iterdir()} - wanted.keys():
        (FOLDER / old).unlink()
    for name, each in wanted.items():
        if not (FOLDER / name).exists():
            (FOLDER / name).write_bytes(zlib.compress(each.made(toolchain), 9))
        print(f"{name[:12]}  {(FOLDER / name).stat().st_size:7,} bytes  {', '.join(each.sources)[:60]}")


if __name__ == "__main__":
    main()
