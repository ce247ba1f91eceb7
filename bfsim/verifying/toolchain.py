"""The Blackfin's toolchain: GCC and the GNU simulator, found on the PATH or in a folder."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bfsim.errors import ConfigError

GCC, SIMULATOR = "bfin-elf-gcc", "bfin-elf-run"
CPU = ("-mcpu=bf561", "-msim")


@dataclass(frozen=True, slots=True)
class Toolchain:
    """A C compiler with the options for its machine, and the program that runs what it makes, if one is needed."""

    compiler: tuple[str, ...]
    runner: tuple[str, ...] = ()

    @property
    def version(self) -> str:
        """What the compiler says its version is."""
        return self._output(self.compiler[0], "-dumpfullversion").strip()

    def build(self, folder: Path, sources: Sequence[str], options: Sequence[str]) -> Path:
        """Compile and link C files in `folder`; return the program. Raises ConfigError with what the compiler says."""
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


def blackfin_toolchain(folder: Path | None = None) -> Toolchain:
    """Find GCC and the GNU simulator for the Blackfin: in `folder` or its `bin`, or on the PATH.

    Raises ConfigError where one is missing.
    """
    places = None if folder is None else f"{folder}:{folder / 'bin'}"
    found = [shutil.which(each, path=places) for each in (GCC, SIMULATOR)]
    if None in found:
        missing = GCC if found[0] is None else SIMULATOR
        where = "on the PATH" if folder is None else f"in {folder}"
        raise ConfigError(
            f"{missing} must be {where}, but is not; CONTRIBUTING.md says how to build a toolchain in ten minutes, and "
            "--toolchain FOLDER names another place"
        )
    gcc, simulator = (str(each) for each in found)
    return Toolchain((gcc, *CPU), (simulator,))
