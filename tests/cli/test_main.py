"""The command line as far as it goes without a simulation."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bfsim import __version__
from bfsim.cli.main import main
from bfsim.cli.record.import_pictures import SOURCE_FORMATS
from bfsim.process import look_alikes
from bfsim.recording.importing import sources
from tests.tiers import exhaustive


def call(*arguments: str) -> Result:
    """Call the command line in this process; unexpected exceptions come through."""
    return CliRunner().invoke(main, arguments, catch_exceptions=False, prog_name="bfsim")


def test_version() -> None:
    """The version is the package's."""
    assert call("--version").output == f"bfsim, version {__version__}\n"


def test_help_lists_the_commands() -> None:
    """Every command has a line, and no line is cut short."""
    output = call("--help").output
    assert all(f"\n  {name}" in output for name in ("run", "profile", "check", "record"))
    assert "..." not in output.partition("Commands:")[2]


@pytest.mark.parametrize("command", ["run", "profile", "check"])
def test_help_of_a_command_teaches_by_example(command: str) -> None:
    """Examples stand one per line, and defaults are told."""
    output = call(command, "--help").output
    assert f"Examples:\n    bfsim {command}" in output
    assert "[default: cm-bf561]" in output


HEAVY = {
    "numpy",
    "numba",
    "llvmlite",
    "simpy",
    "pydantic",
    "tomlkit",
    "lark",
    "mcap",
    "PIL",
    "bfsim.recording",
}


@pytest.mark.parametrize(
    "command", ["--version", "--help", "run --help", "record import --help", "ldf --help"]
)
def test_help_is_quick(command: str) -> None:
    """Help must not wait for the simulator's libraries, nor for the recordings."""
    program = f"""
import atexit, sys
sys.argv[1:] = {command.split()!r}
atexit.register(lambda: print(sorted({HEAVY} & set(sys.modules))))
from bfsim.__main__ import main
main()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_run_imports_only_what_it_needs() -> None:
    """What compiles and costs kernels, reads pictures and writes them waits for somebody to need it."""
    late = {
        "PIL",
        "bfsim.kernel.estimate.costing",
        "bfsim.kernel.emitting.emit",
        "bfsim.recording.importing.importer",
        "numba",
        "pydantic",
    }
    program = f"import sys, bfsim.run; print(sorted({late} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_the_formats_of_pictures_are_all_offered() -> None:
    """The command line knows them without importing what reads them."""
    assert SOURCE_FORMATS == sources.SOURCE_FORMATS


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "--frames", "0"], "'--frames'"),
        (["run", "--feed", "sometimes"], "'sometimes' is not one of 'demand', 'recorded'"),
        (["profile", "--core", "C"], "'C' is not one of 'A', 'B'"),
        (["check"], "Missing option '--baseline'"),
        (["fly"], "No such command 'fly'"),
    ],
)
def test_wrong_usage_ends_with_2(arguments: list[str], message: str) -> None:
    """A slip in the arguments is told by name."""
    result = call(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr


def test_error_is_one_paragraph_on_stderr(tmp_path: Path) -> None:
    """A mistake that bfsim knows ends with 2, its message and nothing else; before anything is simulated."""
    path = tmp_path / "bfsim.toml"
    result = call("check", "--baseline", str(path))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr == (
        f"bfsim: error: {path} must be a baseline file, but there is none: `bfsim check --update` makes it\n"
    )


def test_place_of_the_json_is_tried_before_the_run(tmp_path: Path) -> None:
    """Nobody waits for a run whose result cannot be written."""
    result = call("run", "--json", str(tmp_path / "missing" / "run.json"))
    assert result.exit_code == 2
    assert "missing must exist to write a file there" in result.stderr


@pytest.mark.parametrize("command", [["boards"], *exhaustive(["explain", "isqrt32", "--json"], ["ldf"])])
def test_a_full_disk_behind_standard_output(command: list[str]) -> None:
    """One sentence, and the exit code of a mistake: 1 is for broken limits."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "bfsim", *command],
            stdout=full,
            check=False,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 2
    assert done.stderr == "bfsim: error: standard output must be accessible: No space left on device\n"


def test_closed_streams() -> None:
    """`>&- 2>&-` means that nobody wants to read; the command does its work all the same."""
    command = 'exec "$0" -m bfsim explain isqrt32 --json >&- 2>&-'
    assert subprocess.run(["/bin/sh", "-c", command, sys.executable], check=False).returncode == 0


def test_ctrl_c_while_the_command_line_is_imported(tmp_path: Path) -> None:
    """Who changes their mind at once gets no traceback, either."""
    (tmp_path / "click.py").write_text("import signal\nsignal.raise_signal(signal.SIGINT)\n")
    done = subprocess.run(
        [sys.executable, "-m", "bfsim", "boards"],
        env={**os.environ, "PYTHONPATH": f"{tmp_path}:{Path(__file__).parents[2]}"},
        capture_output=True,
        check=False,
        text=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "bfsim: interrupted\n")


def test_a_terminal_with_no_room_and_few_letters() -> None:
    """Tables need some columns, and letters that the encoding lacks become others."""
    surroundings = {**os.environ, "COLUMNS": "1", "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        [sys.executable, "-m", "bfsim", "boards", "cm-bf561"],
        capture_output=True,
        check=False,
        env=surroundings,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.isascii()


@pytest.mark.parametrize("encoding", ["ascii", "latin1", "cp437"])
def test_bars_are_bars_in_every_encoding(encoding: str) -> None:
    """Work, stalls and idling were question marks, one as the other; what looks like nothing in ASCII still is one."""
    signs = "█▓░▏·"
    assert len(set(signs.encode(encoding, look_alikes.NAME))) == len(signs), "they stay apart"
    told = "█▓░ ▏ a… 10° 3 → 4 \u4e16"
    written = told.encode(encoding, look_alikes.NAME).decode(encoding)
    assert len(written) == len(told), "tables stay tables"
    assert written.endswith("?")
    assert encoding != "ascii" or written == "#=: | a~ 10o 3 > 4 ?"


@pytest.mark.parametrize("command", ["run", "profile"])
@pytest.mark.parametrize("written", ["--json", "--trace", "--html"])
@pytest.mark.parametrize("other", ["--script", "--ldf", "--work", "--record-work", "recording"])
def test_what_is_written_takes_the_place_of_nothing_else(
    tmp_path: Path, command: str, written: str, other: str
) -> None:
    """A recording that is given twice by a slip is still there afterwards."""
    file = tmp_path / "drive.json"
    file.touch()
    option = [] if other == "recording" else [other]
    result = call(command, *option, str(file), written, str(tmp_path / "." / "drive.json"))
    assert result.exit_code == 2
    assert "drive.json must be a file of its own to be written" in result.output


@pytest.mark.parametrize("command", ["run", "profile"])
@pytest.mark.parametrize("written", ["--trace", "--html", "--flame"])
@pytest.mark.parametrize("name", ["mine.py", "mine.py:it", "mine", "mine:it"])
@pytest.mark.parametrize("option", ["--firmware", "--board", "--profile"])
def test_what_is_written_takes_the_place_of_no_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, written: str, name: str, option: str
) -> None:
    """`--trace mine.py` left a timeline in the place of the firmware."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("it = 1\n")
    result = call(command, option, name, written, "mine.py")
    assert result.exit_code == 2
    assert "mine.py must be a file of its own to be written" in result.output
    assert Path("mine.py").read_text() == "it = 1\n"


@pytest.mark.parametrize("option", ["--json", "--mcap", "--baseline"])
def test_links_in_a_circle(tmp_path: Path, option: str) -> None:
    """They are told before anything runs."""
    loop = tmp_path / "loop.json"
    loop.symlink_to(loop)
    command = ("check", "--update") if option == "--baseline" else ("run",)
    result = call(*command, option, str(loop))
    assert result.exit_code == 2
    assert f"{loop} must lead to a place, not in a circle of links" in result.stderr


@pytest.mark.parametrize(
    "arguments",
    [["boards", "x" * 35_000], ["fly" * 10_000], ["run", "--frames", "9" * 35_000], ["boards", "a\0b"]],
)
def test_messages_are_short(arguments: list[str]) -> None:
    """Whatever was given."""
    result = call(*arguments)
    assert result.exit_code == 2
    assert 0 < len(result.stderr) < 1300
