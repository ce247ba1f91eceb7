"""The Blackfin's toolchain: GCC and the GNU simulator, found on the PATH or in a folder."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from bfsim.errors import ConfigError, printable

GCC, SIMULATOR = "bfin-elf-gcc", "bfin-elf-run"
CPU = ("-mcpu=bf561", "-msim")
ADVICE = "CONTRIBUTING.md says how to build a toolchain in ten minutes, and --toolchain FOLDER takes another than the PATH's"
ERROR = re.compile(r"(?!collect2:).*\berror:", re.IGNORECASE)
"""[GCC] Errors of the compiler have `error:`, those of the assembler `Error:`; collect2 only says that the linker failed."""
MOST_LINES = 10
LIBRARIES = ("-lm", "-lc", "-lgcc")


class Compiler(NamedTuple):
    """A compiler's identity: the machine that it makes code for, its version, and the options for that machine."""

    machine: str
    version: str
    options: tuple[str, ...]


@dataclass(frozen=True)
class Toolchain:
    """A C compiler with the options for its machine, and the program that runs what it makes, if one is needed.

    Objects take what they need out of `libraries`.
    """

    compiler: tuple[str, ...]
    runner: tuple[str, ...] = ()
    libraries: tuple[str, ...] = ()

    @cached_property
    def identity(self) -> Compiler:
        """The identity that the compiler states."""
        gcc, *options = self.compiler
        machine, version = (self._output(gcc, each).strip() for each in ("-dumpmachine", "-dumpfullversion"))
        return Compiler(machine, version, tuple(options))

    def build_object(self, folder: Path, sources: Sequence[str], options: Sequence[str]) -> Path:
        """Compile files in `folder` into one object file with all of the libraries that they need; return it.

        Raises ConfigError with what the compiler says.
        """
        whole = folder / "kernels.o"
        self._output(*self.compiler, *options, "-c", *sources, folder=folder)
        parts = [f"{Path(each).stem}.o" for each in sources]
        self._output(
            *self.compiler, "-r", "-nostdlib", *parts, *self.libraries, "-o", whole.name, folder=folder
        )
        if not whole.is_file():
            raise ConfigError(f"{self.compiler[0]} must be GCC for the Blackfin, but makes no object file")
        return whole

    def build(self, folder: Path, sources: Sequence[str], options: Sequence[str]) -> Path:
        """Compile and link files in `folder`; return the program. Raises ConfigError with what the compiler says."""
        program = folder / "program"
        self._output(*self.compiler, *options, *sources, "-lm", "-o", program.name, folder=folder)
        return program

    def run(self, program: Path) -> str:
        """Run a program in its folder; return what it prints."""
        return self._output(*self.runner, str(program), folder=program.parent)

    def _output(self, *command: str, folder: Path | None = None) -> str:
        import subprocess  # most starts ask no compiler

        done = subprocess.run(  # noqa: S603, the user's own compiler and what it made
            command, check=False, capture_output=True, text=True, errors="replace", cwd=folder
        )
        if done.returncode:
            said = (
                "\n".join(_from_the_first_error(done.stderr.splitlines())) or f"exit code {done.returncode}"
            )
            raise ConfigError(f"{command[0]} must run without an error, but says: {said}")
        return done.stdout


def _from_the_first_error(lines: Sequence[str]) -> list[str]:
    """Return the first lines of what a compiler says, without the warnings before an error."""
    first = next((number for number, each in enumerate(lines) if ERROR.match(each)), 0)
    return [printable(each) for each in lines[first : first + MOST_LINES]]  # the file may be anything


def prefer(folder: Path) -> None:
    """Look for the toolchain in `folder`, or its `bin`, before the PATH: in this process, and in those that it starts.

    Raises ConfigError if GCC is not there.
    """
    folders = os.pathsep.join(str(each.absolute()) for each in (folder, folder / "bin"))
    if shutil.which(GCC, path=folders) is None:
        raise _missing(GCC, f"in {folder}")
    os.environ["PATH"] = os.pathsep.join((folders, os.environ.get("PATH", os.defpath)))


def blackfin_compiler() -> Toolchain | None:
    """Find GCC for the Blackfin on the PATH, and the GNU simulator if it is there. Returns None if there is no GCC."""
    gcc, simulator = map(shutil.which, (GCC, SIMULATOR))
    return Toolchain((gcc, *CPU), (simulator,) if simulator else (), LIBRARIES) if gcc else None


def blackfin_toolchain() -> Toolchain:
    """Find GCC and the GNU simulator for the Blackfin. Raises ConfigError if one is missing."""
    found = blackfin_compiler()
    if found is None or not found.runner:
        raise _missing(SIMULATOR if found else GCC, "on the PATH")
    return found


def _missing(name: str, where: str) -> ConfigError:
    return ConfigError(f"{name} must be {where}, but is not; {ADVICE}")
