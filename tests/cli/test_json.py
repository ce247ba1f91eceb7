"""`--json` of every command that has it: one rule for what it takes, prints and writes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from bfsim.cli.main import main
from bfsim.errors import ConfigError
from tests.eyes import FIRMWARE, record

RUNS = ["drive.mcap", "--firmware", "fw_eyes.py", "--frames", "1"]
COMMANDS = {
    "run": ["run", *RUNS],
    "profile": ["profile", *RUNS],
    "place": ["place", *RUNS],
    "explain": ["explain", "threshold", "--firmware", "fw_eyes.py"],
    "check": ["check", *RUNS, "--baseline", "limits.toml", "--update"],
    "diff": ["diff", " ".join(RUNS), " ".join(RUNS)],
    "ldf": ["ldf", "l2"],
    "colours": ["colours", "drive.mcap", "--firmware", "tinyphoon"],
    "record info": ["record", "info", "drive.mcap"],
}
"""A command line of each command but `verify`, which needs a compiler."""


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with firmware and a recording, where the user is."""
    (tmp_path / "fw_eyes.py").write_text(FIRMWARE)
    record(tmp_path / "drive.mcap", 1)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call(*arguments: str) -> Result:
    """Call the command line in this process."""
    return CliRunner(env={"COLUMNS": "80"}).invoke(main, arguments)


def refused(*arguments: str) -> str:
    """Return what is said of a mistake."""
    done = call(*arguments)
    assert (done.exit_code, done.stdout) == (2, ""), done.output
    return " ".join(done.stderr.split())


def with_json(group: click.Group, above: str = "") -> Iterator[tuple[str, click.Option]]:
    """Yield the name of each command that has the option, and the option."""
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from with_json(command, f"{name} ")
        for each in command.params:
            if "--json" in each.opts:
                assert isinstance(each, click.Option)
                yield above + name, each


def test_it_is_the_same_option_everywhere() -> None:
    """One that prints without a file, and is one word of the help."""
    found = dict(with_json(main))
    assert set(found) == {*COMMANDS, "verify"}
    assert {(each.name, each.metavar, type(each)) for each in found.values()} == {
        ("json_path", "[FILE.json]", type(found["run"]))
    }


@pytest.mark.parametrize("name", COMMANDS)
def test_alone_it_prints_json_and_nothing_else(name: str) -> None:
    """What else there is to say goes to standard error."""
    done = call(*COMMANDS[name], "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)


@pytest.mark.parametrize("name", COMMANDS)
def test_with_a_file_it_writes_it_beside_the_report(home: Path, name: str) -> None:
    """What is printed is what would be without it, and the file has what it prints without a file."""
    file = home / "out.json"
    with_file = call(*COMMANDS[name], "--json", "out.json")
    assert with_file.exit_code == 0, with_file.output
    assert with_file.stdout == call(*COMMANDS[name]).stdout
    assert file.read_text() == call(*COMMANDS[name], "--json").stdout


@pytest.mark.parametrize("name", ["run", "explain", "diff", "record info"])
def test_the_report_is_printed_although_the_file_has_no_room(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was found may have taken hours; then the error."""

    def full(path: Path, _content: object) -> None:
        raise ConfigError(f"{path} must be writable: No space left on device")

    report = call(*COMMANDS[name]).stdout
    monkeypatch.setattr("bfsim.files.save.write_bytes", full)
    done = call(*COMMANDS[name], "--json", "out.json")
    assert (done.exit_code, done.stdout) == (2, report)
    assert done.stderr.endswith("out.json must be writable: No space left on device\n")


@pytest.mark.parametrize("name", dict(with_json(main)))
def test_a_file_behind_it_is_never_taken_for_its_own(home: Path, name: str) -> None:
    """`bfsim place --json drive.mcap` would have written over the recording."""
    before = (home / "drive.mcap").read_bytes()
    message = refused(*name.split(), "--json", "drive.mcap")
    assert "'--json': must be followed by a FILE.json to write, not 'drive.mcap'" in message
    assert "to print the JSON, put --json last" in message
    assert (home / "drive.mcap").read_bytes() == before


@pytest.mark.parametrize(
    "arguments", ["--json a.json b.json", "a.json --json b.json", "--json=a.json b.json"]
)
def test_a_result_behind_it_is_never_written_over(home: Path, arguments: str) -> None:
    """Who means to print the difference of two results is told where the word must stand."""
    for name in ("a.json", "b.json"):
        (home / name).write_text(name)
    message = refused("diff", *arguments.split())
    assert "as the file to write, and AFTER must be given, too; to print the JSON, put --json last" in message
    assert [(home / name).read_text() for name in ("a.json", "b.json")] == ["a.json", "b.json"]


def test_a_file_that_is_read_is_never_written_over(home: Path) -> None:
    """A result that is compared, and orders of a script."""
    assert call(*COMMANDS["run"], "--json", "a.json").exit_code == 0
    text = (home / "a.json").read_text()
    for arguments in (["diff", "a.json", "a.json"], [*COMMANDS["place"], "--script", "a.json"]):
        assert "a.json must be a file of its own to be written" in refused(*arguments, "--json", "a.json")
    assert (home / "a.json").read_text() == text
