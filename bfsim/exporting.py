"""Export the kernels of firmware as a folder of C: for the robot's own firmware, and for reading."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from bfsim.errors import ConfigError, FirmwareError, listed
from bfsim.files.save import write_text, writing
from bfsim.kernel import Kernel
from bfsim.kernel.c import CProgram, c_program, in_python
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernels import kernels_of, written_in_python

MAKEFILE = """\
# Exported by bfsim. `make` compiles the kernels for the Blackfin; `make CC=gcc CPU=` for this machine.
CC = bfin-elf-gcc
AR = $(CC:gcc=ar)
CPU = -mcpu=bf561
CFLAGS = -O2 -std=c99 -Wall -Wextra
OBJECTS = {objects}

libkernels.a: $(OBJECTS)
\t$(AR) rcs $@ $(OBJECTS)

%.o: %.c kernels.h operators.h
\t$(CC) $(CPU) $(CFLAGS) -c $< -o $@

clean:
\trm -f $(OBJECTS) libkernels.a

.PHONY: clean
"""


@dataclass(frozen=True, slots=True)
class Export:
    """What was written to `folder`: the names of the files, and the numbers of kernels and of lines of C.

    `left`: kernels in other languages.
    """

    folder: Path
    files: tuple[str, ...]
    kernels: int
    lines: int
    left: tuple[str, ...]


def export(firmware: str, folder: Path, *, line_directives: bool = False, force: bool = False) -> Export:
    """Write the kernels of `firmware` as C99 to `folder`, with a header and a makefile.

    Raises ConfigError if `folder` is a file, or if it already has a file of such a name, which somebody may have changed,
    and `force` is not set. Raises FirmwareError if the firmware has no kernels in Python.
    """
    if folder.exists() and not folder.is_dir():
        raise ConfigError(f"{folder} must be a folder to write the files of C to, not a file")
    own = kernels_of(load_firmware(firmware).own)
    kernels = written_in_python(own)
    if not kernels:
        has = f"only {listed(_names(own), 6)}, in another language" if own else "none"
        raise FirmwareError(f"{firmware} must have kernels in Python to be exported as C, and has {has}")
    program = c_program((each.function for each in kernels), place=in_python if line_directives else None)
    files = {**program.files, "Makefile": _makefile(program)}
    if not force and (there := [each for each in files if (folder / each).exists()]):
        raise ConfigError(
            f"{folder} must be without {there[0]}, which would be overwritten; take another folder, or --force"
        )
    with _whole(folder):
        for name, text in files.items():
            write_text(folder / name, text)
    lines = sum(text.count("\n") for name, text in program.files.items() if name.endswith(".c"))
    return Export(folder, tuple(files), len(program.names), lines, tuple(_names(own - kernels)))


@contextmanager
def _whole(folder: Path) -> Iterator[None]:
    """Make a folder for what the `with` block writes; after an error, remove it if it was new."""
    is_new = not folder.exists()
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        if is_new:
            shutil.rmtree(folder, ignore_errors=True)
        raise


def _names(kernels: Iterable[Kernel]) -> list[str]:
    return sorted(f"{each.name} ({Path(each.function.file).name})" for each in kernels)


def _makefile(program: CProgram) -> str:
    return MAKEFILE.format(objects=" ".join(f"{each.removesuffix('.c')}.o" for each in program.sources))
