"""The Blackfin's toolchain: GCC and the GNU simulator, found on the PATH or in a folder."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from bfsim.errors import ConfigError

GCC, SIMULATOR = "bfin-elf-gcc", "bfin-elf-run"
CPU = ("-mcpu=bf561", "-msim")
ADVICE = "CONTRIBUTING.md says how to build a toolchain in ten minutes, and `bfsim verify --toolchain FOLDER` takes another than the PATH's"
LIBRARIES = ("-lm", "-lc", "-lgcc")


class Compiler(NamedTuple):
    """Which compiler it is: the machine that it makes code for, its version, and the options for that machine."""

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
        """What the compiler says that it is."""
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
        done = subprocess.run(  # noqa: S603, the user's own compiler and what it made
            command, check=False, capture_output=True, text=True, cwd=folder
        )
        if done.returncode:
            said = "\n".join(done.stderr.splitlines()[:10]) or f"exit code {done.returncode}"
            raise ConfigError(f"{command[0]} must run without an error, but says: {said}")
        return done.stdout


def blackfin_compiler(folder: Path | None = None) -> Toolchain | None:
    """Find GCC for the Blackfin, and the GNU simulator if it is there: in `folder` or its `bin`, or on the PATH.

    Returns None if there is no GCC on the PATH. Raises ConfigError if there is none in the `folder` that was named.
    """
    gcc, simulator = (_program(each, folder) for each in (GCC, SIMULATOR))
    if gcc is None:
        if folder is not None:
            raise _missing(GCC, folder)
        return None
    return Toolchain((gcc, *CPU), (simulator,) if simulator else (), LIBRARIES)


def blackfin_toolchain(folder: Path | None = None) -> Toolchain:
    """Find GCC and the GNU simulator for the Blackfin, as `blackfin_compiler`. Raises ConfigError where one is missing."""
    found = blackfin_compiler(folder)
    if found is None or not found.runner:
        raise _missing(SIMULATOR if found else GCC, folder)
    return found


def _program(name: str, folder: Path | None) -> str | None:
    return shutil.which(name, path=None if folder is None else f"{folder}:{folder / 'bin'}")


def _missing(name: str, folder: Path | None) -> ConfigError:
    where = "on the PATH" if folder is None else f"in {folder}"
    return ConfigError(f"{name} must be {where}, but is not; {ADVICE}")
