"""Generator functions of firmware that are called without `yield from`: the source tells."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.errors import FirmwareError
from bfsim.loading.firmware import load_firmware
from bfsim.run import simulate

FIRMWARE = """
import helpers
from helpers import edges
from bfsim.api import Firmware

def lines(core):
    yield

def plain(core):
    return lines(core)

class Eye:
    def see(self, core):
        yield

def main(core):
    def local(core):
        yield
    while (yield from core.next_frame()) is not None:
        {statement}

def script(core):
    lines(core)

fw = Firmware(mains={{"A": main, "B": main}}, buffers=lambda size: {{}}, camera="camera", rows=())
"""
HELPERS = "def edges(core):\n    yield\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty one with a module of helpers, in which commands are given."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "helpers.py").write_text(HELPERS)
    return tmp_path


def written(statement: str) -> str:
    """Write firmware with a statement in its main loop; return its name."""
    Path("eye.py").write_text(FIRMWARE.format(statement=statement))
    return "eye.py:fw"


@pytest.mark.parametrize("name", ["lines", "edges", "helpers.edges", "local"])
def test_a_generator_that_nobody_takes_is_told_with_its_line(folder: Path, name: str) -> None:
    """Its stage ran in no time, and nobody said why. The function stands in the file, in a module or in the loop."""
    with pytest.raises(FirmwareError) as caught:
        load_firmware(written(f"{name}(core)"))
    assert (
        str(caught.value)
        == f"{name}(...) does nothing: write `yield from` before it ({folder / 'eye.py'}:20)"
    )


@pytest.mark.parametrize(
    "statement",
    [
        "yield from lines(core)",
        "plain(core)",
        "unknown(core)",
        "Eye().see(core)",
        "later = lines(core); yield from later",
        "lines = print; lines(core)",
        "[lines(core) for each in 'AB']",
    ],
)
def test_what_may_do_something_is_left_alone(folder: Path, statement: str) -> None:
    """A call of another function, or of one that nobody can know; and a script is no main loop."""
    assert load_firmware(written(statement)).firmware.camera == "camera"


def test_firmware_that_is_an_object_is_looked_at_as_well(folder: Path) -> None:
    """As a test or a script has it."""
    firmware = load_firmware(written("yield from lines(core)")).firmware
    Path("eye.py").write_text(FIRMWARE.format(statement="lines(core)"))
    with pytest.raises(FirmwareError, match=r"^lines\(\.\.\.\) does nothing: .*eye\.py:20\)$"):
        simulate(frames=1, firmware=firmware)
