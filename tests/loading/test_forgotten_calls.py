"""Generator functions of firmware that are called without `yield from`: the source tells."""

from __future__ import annotations

import importlib.util
import sys
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

def spare(core):
    yield lines(core)
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


def test_one_under_a_name_that_nobody_reads_is_told_too(folder: Path) -> None:
    """`count = lines(core)` took no time, without a word."""
    with pytest.raises(
        FirmwareError, match=r"^lines\(\.\.\.\) does nothing: write `yield from` before it \(.*eye\.py:20\)$"
    ):
        load_firmware(written("count = lines(core)"))


def test_main_loops_that_a_function_makes_are_looked_at_as_well(folder: Path) -> None:
    """What they close over may call it."""
    text = (
        FIRMWARE.format(statement="yield from lines(core)")
        + """
def made(body):
    def main(core):
        yield from body(core)
    return main

def body(core):
    yield
    lines(core)

loop = made(body)
other = Firmware(mains={"A": loop, "B": loop}, buffers=lambda size: {}, camera="camera", rows=())
"""
    )
    Path("eye.py").write_text(text)
    assert load_firmware("eye.py:fw").firmware.camera == "camera"
    with pytest.raises(FirmwareError, match=r"^lines\(\.\.\.\) does nothing: "):
        load_firmware("eye.py:other")


def test_it_may_stand_in_what_the_main_loop_calls(folder: Path) -> None:
    """In a function of another module."""
    Path("helpers.py").write_text(
        "def edges(core):\n    yield\n    more(core)\n\ndef more(core):\n    yield\n"
    )
    with pytest.raises(FirmwareError, match=r"^more\(\.\.\.\) does nothing: .*helpers\.py:3\)$"):
        load_firmware(written("yield from helpers.edges(core)"))


def test_it_may_stand_in_a_function_that_yields_nothing(folder: Path) -> None:
    """Such as a handler of an interrupt."""
    statement = "def handler(core): lines(core)\n        core.on_interrupt('SPI_DMA', handler)"
    with pytest.raises(FirmwareError, match=r"lines\(\.\.\.\) does nothing"):
        load_firmware(written(statement))


RING = "ring = core.input_ring(core.rows('camera'), 'ring'); "


@pytest.mark.parametrize("call", ["ring.line", "ring.row", "ring.flush"])
def test_a_wait_for_a_ring_that_nobody_takes_is_told(folder: Path, call: str) -> None:
    """From the second picture on a ring may have a line at once: as the firmware runs nobody would notice."""
    with pytest.raises(FirmwareError, match=rf"{call}\(\.\.\.\) does nothing: write `yield from` before it"):
        load_firmware(written(f"{RING}{call}()"))


@pytest.mark.parametrize(
    "statement",
    [
        f"{RING}yield from ring.line()",
        f"{RING}ring = core; ring.line()",
        f"{RING}ring.send()",
        "ring.line()",
        "yield from lines(core)",
        "plain(core)",
        "unknown(core)",
        "Eye().see(core)",
        "later = lines(core); yield from later",
        "global later; later = lines(core)",
        "core.later = lines(core)",
        "lines = print; lines(core)",
        "[lines(core) for each in 'AB']",
    ],
)
def test_what_may_do_something_is_left_alone(folder: Path, statement: str) -> None:
    """A call of another function, or of one that nobody can know; and a loop that is not run."""
    assert load_firmware(written(statement)).firmware.camera == "camera"


def test_firmware_that_is_an_object_is_looked_at_as_well(folder: Path) -> None:
    """As a test or a script has it."""
    name = written("lines(core)")
    spec = importlib.util.spec_from_file_location("eye", name.removesuffix(":fw"))
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        patch.setitem(sys.modules, "eye", module)
        spec.loader.exec_module(module)
        with pytest.raises(FirmwareError, match=r"^lines\(\.\.\.\) does nothing: .*eye\.py:20\)$"):
            simulate(frames=1, firmware=module.fw)
        del sys.modules["helpers"]
