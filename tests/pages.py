"""What a page of the documentation has in code blocks, and how to play it in a folder.

A block with a title, ```python title="brightness.py"```, is a file. A `console` block is commands, each behind `$ `, with
what they print beneath: those lines must appear in that order, and a line `...` stands for any number of others. Other
`python` blocks are run as scripts. A comment `<!-- run by FILE -->` before a block names who runs it instead.
"""

from __future__ import annotations

import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import chdir, contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.compiling.toolchain import GCC

ROOT = Path(__file__).parent.parent
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
PLAIN = re.compile(r"bfsim [^|&;<>$`*?(){}#~\\]+")
"""A command of bfsim that no shell must read: it is called in this process, for a new one would first import all anew."""
FENCE = re.compile(
    r"^(?:<!-- run by (?P<runner>\S+) -->\n)?(?P<indent> *)```(?P<language>\w*)(?P<options>[^\n]*)\n"
    r"(?P<text>.*?)^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class Block:
    """One code block. `title` names the file that it is, `runner` the file of the project that runs it, or nothing."""

    line: int
    language: str
    title: str
    runner: str
    text: str

    def commands(self) -> Iterator[tuple[str, list[str]]]:
        """Yield each command of a `console` block with the lines that it should print."""
        command, printed = "", list[str]()
        for line in self.text.splitlines():
            if line.startswith("$ "):
                if command:
                    yield command, printed
                command, printed = line.removeprefix("$ "), []
            else:
                printed.append(line)
        if command:
            yield command, printed


def blocks_of(page: Path) -> list[Block]:
    """Return the code blocks of a page, in their order."""
    text = page.read_text()
    return [
        Block(
            line=text.count("\n", 0, found.start()) + 1,
            language=found["language"],
            title="".join(re.findall(r'title="([^"]+)"', found["options"])),
            runner=found["runner"] or "",
            text=re.sub(rf"^{found['indent']}", "", found["text"], flags=re.MULTILINE),
        )
        for found in FENCE.finditer(text)
    ]


def path_without_compiler() -> str:
    """Return the PATH of somebody without GCC for the Blackfin."""
    folders = os.environ["PATH"].split(os.pathsep)
    return os.pathsep.join(each for each in folders if not (Path(each) / GCC).exists())


@contextmanager
def reader() -> Iterator[Reader]:
    """Yield somebody with an empty folder and an installed `bfsim`, also where only the sources are on the path."""
    with tempfile.TemporaryDirectory() as temporary:
        home = Path(temporary)
        command = home / "bin" / "bfsim"
        command.parent.mkdir()
        command.write_text(f'#!/bin/sh\nexec {sys.executable} -m bfsim "$@"\n')
        command.chmod(0o755)
        folder = home / "reader"
        folder.mkdir()
        environment = {
            **os.environ,
            "PATH": f"{command.parent}:{Path(sys.executable).parent}:{path_without_compiler()}",
            "PYTHONPATH": f"{ROOT}:{ROOT / 'firmware'}",
            "COLUMNS": "80",
        }
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(
                "bfsim.cli.sweep.NOTE_S", math.inf
            )  # notes by the clock, which a slow machine prints
            yield Reader(folder, environment)


@dataclass(frozen=True, slots=True)
class Reader:
    """Who does what a page says, block by block, in `folder`."""

    folder: Path
    environment: Mapping[str, str]

    def play(self, block: Block) -> Iterator[tuple[str, list[str], str]]:
        """Do what a block says; yield each command with the lines that it should print and what it prints.

        Raises AssertionError where something fails.
        """
        if block.title:
            file = self.folder / block.title
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block.text)
        elif block.language == "console":
            for command, printed in block.commands():
                yield command, printed, self._output_of(command)
        elif block.language == "python":
            _execute(block, self.folder)

    def _output_of(self, command: str) -> str:
        if PLAIN.fullmatch(command):
            return _called(command, self.folder, self.environment)
        return _run(["bash", "-c", f"set -euo pipefail\n{command}"], self.folder, self.environment)


def _called(command: str, folder: Path, environment: Mapping[str, str]) -> str:
    with chdir(folder):
        done = CliRunner().invoke(main, shlex.split(command)[1:], env=environment, prog_name="bfsim")
    assert done.exit_code == 0, f"{command}\n{done.output}"
    return done.output


def _execute(block: Block, folder: Path) -> None:
    """Do what a script would, in this process too; what it imports from `folder` is forgotten afterwards."""
    known = set(sys.modules)
    with chdir(folder), pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        exec(compile(block.text, f"line {block.line}", "exec"), {"__name__": "__main__"})
    for name in set(sys.modules) - known:
        if (getattr(sys.modules[name], "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]


def _run(command: list[str], folder: Path, environment: Mapping[str, str]) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command[-1]}\n{done.stdout}"
    return done.stdout


def compare(printed: list[str], output: str, what: str) -> None:
    """Raise AssertionError unless the lines are printed in their order; only `...` stands for lines left out."""
    rest = [line.rstrip() for line in output.splitlines() if line.strip()]
    may_skip = False
    for line in (each.rstrip() for each in printed if each.strip()):
        if line == "...":
            may_skip = True
            continue
        skipped = rest.index(line) if line in rest else len(rest)
        assert skipped < len(rest), f"{what} must print {line!r}, but prints\n{output}"
        assert may_skip or not skipped, f"{what} prints {rest[0]!r} before {line!r}"
        rest, may_skip = rest[skipped + 1 :], False
