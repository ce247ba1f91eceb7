"""What commands write beside their reports replaces what they wrote before, and nothing else."""

from __future__ import annotations

from pathlib import Path
from re import Pattern

import pytest

from bfsim import shipped
from bfsim.errors import ConfigError
from bfsim.files import outputs
from bfsim.files.outputs import require_own
from tests.commands import bfsim

PHOTO = b"\xff\xd8\xff\xe0\x00\x10JFIF"
EVERY = [
    getattr(outputs, name)
    for name in ("JSON", "PAGE", "JUNIT", "MARKDOWN", "BENCHMARK", "TRACE", "FLAME", "WORK")
]


@pytest.mark.parametrize("output", EVERY)
@pytest.mark.parametrize(
    "theirs",
    [PHOTO, b'{"name": "site"}\n', b"<!doctype html>\n<title>My robot</title>", b"# Robot\n", b"PK\x03\x04"],
)
def test_files_of_the_user_are_not_replaced(tmp_path: Path, theirs: bytes, output: Pattern[bytes]) -> None:
    """Whoever forgets a FILE behind an option names a photo, a recording, a page of theirs: it was written over."""
    there = tmp_path / "there"
    require_own(there, output)
    there.touch()  # as mktemp makes it
    require_own(there, output)
    there.write_bytes(theirs)
    with pytest.raises(
        ConfigError, match="must not be there yet: it holds something else than what is written there"
    ):
        require_own(there, output)
    assert there.read_bytes() == theirs


def test_what_commands_wrote_they_replace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each output is known by its beginning, and by no other's."""
    monkeypatch.chdir(tmp_path)
    commands = (
        "run --frames 1 --json r.json --html r.html --trace r.pftrace --flame f.json",
        "run --frames 1 --record-work r.work",
        "check --frames 1 --baseline b.toml --update --junit j.xml --markdown m.md --benchmark be.json --json c.json",
        "diff r.json r.json --json d.json --html d.html",
        "colours --json colours.json",
        f"record info {shipped.RECORDING} --json info.json",
    )
    for command in commands * 2:
        done = bfsim(*command.split())
        assert done.exit_code == 0, done.output
    written = {
        outputs.JSON: {"r.json", "c.json", "d.json", "colours.json", "info.json"},
        outputs.PAGE: {"r.html", "d.html"},
        outputs.JUNIT: {"j.xml"},
        outputs.MARKDOWN: {"m.md"},
        outputs.BENCHMARK: {"be.json"},
        outputs.TRACE: {"r.pftrace"},
        outputs.FLAME: {"f.json"},
        outputs.WORK: {"r.work"},
    }
    assert set(written) == set(EVERY)
    for output, names in written.items():
        assert {each.name for each in tmp_path.iterdir() if output.match(each.read_bytes())} == names
