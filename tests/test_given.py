"""Firmware that is given as an object: what runs is the same as by its name, and the identity says what it is from."""

from __future__ import annotations

import functools
import linecache
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

from bfsim.loading.firmware import load_firmware
from bfsim.loading.given import CELL, given_firmware
from bfsim.machine.program import Firmware
from bfsim.run import simulate
from tests.eyes import FIRMWARE, record

PACKAGE = {
    "__init__.py": "from fw_pack.parts import main, buffers\nfrom bfsim.api import BudgetRow, Firmware\n"
    "eyes = Firmware(mains={'A': main, 'B': main}, buffers=buffers, camera='camera', rows=(BudgetRow(stage='Threshold'),))\n",
    "parts.py": "from .sizes import ROWS\n" + FIRMWARE.replace("rows=2", "rows=ROWS"),
    "sizes.py": "import math\nfrom . import more\nROWS = more.TWO\n",
    "more.py": "TWO = 2\n",
    "unused.py": "NOTHING = 0\n",
}
"""A package of which the firmware imports all but one module, one of them for a number only."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on Python's path, and the current one, with a module and a package."""
    (tmp_path / "fw_given.py").write_text(FIRMWARE)
    (tmp_path / "fw_pack").mkdir()
    for name, text in PACKAGE.items():
        (tmp_path / "fw_pack" / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - before:
        if name.startswith("fw_"):
            del sys.modules[name]


def imported(name: str) -> Firmware:
    """The firmware `eyes` of a module, as Python imports it."""
    found = import_module(name).eyes
    assert isinstance(found, Firmware)
    return found


def test_an_object_and_its_name_are_one_firmware(folder: Path) -> None:
    """Identity and cycles are equal, in a module as in a package."""
    recording = record(folder / "drive.mcap", 2)
    for name in ("fw_given", "fw_pack"):
        by_name = simulate(recording, firmware=f"{name}:eyes")
        by_object = simulate(recording, firmware=imported(name))
        assert by_object.identity == by_name.identity
        assert by_object.frames == by_name.frames


def test_built_in_firmware_is_known_by_its_name() -> None:
    """Its name, its files and their digest are those of the built-in one."""
    from tinyphoon import tinyphoon

    given, named = given_firmware(tinyphoon), load_firmware("tinyphoon")
    assert (given.name, given.is_built_in) == ("tinyphoon", True)
    assert (given.files, given.digest) == (named.files, named.digest)


def test_a_device_of_a_module_that_python_does_not_keep(folder: Path) -> None:
    """As where a file of firmware is imported by hand: its class is found by its methods."""
    device = (
        "from bfsim.api import SpiDevice\nclass Quiet(SpiDevice):\n"
        "    def __init__(self, script):\n        pass\n"
        "    def requests(self, now_ns):\n        return False\n"
    )
    (folder / "fw_by_hand.py").write_text(
        device + FIRMWARE.replace('camera="camera"', 'camera="camera", spi=Quiet')
    )
    eyes = imported("fw_by_hand")
    del sys.modules["fw_by_hand"]
    assert list(given_firmware(eyes).files) == ["fw_by_hand.py"]


def test_all_that_it_imports_of_its_package_is_in_the_digest(folder: Path) -> None:
    """A module that gives a number only, too; not one that nobody imports."""
    files = ["fw_pack/__init__.py", "fw_pack/more.py", "fw_pack/parts.py", "fw_pack/sizes.py"]
    firmware = imported("fw_pack")
    before = given_firmware(firmware)
    assert list(before.files) == files
    (folder / "fw_pack" / "unused.py").write_text("NOTHING = 1\n")
    assert given_firmware(firmware).digest == before.digest
    (folder / "fw_pack" / "more.py").write_text("TWO = 3\n")
    assert given_firmware(firmware).digest != before.digest


def test_a_changed_copy_has_the_files_of_both(folder: Path) -> None:
    """Where it was changed, and what it was."""
    plain = imported("fw_pack")
    (folder / "fw_mine.py").write_text(
        "from dataclasses import replace\nfrom functools import partial\nfrom fw_pack import eyes as theirs\n"
        "eyes = replace(theirs, buffers=partial(theirs.buffers))\n"
    )
    mine = imported("fw_mine")
    assert isinstance(mine.buffers, functools.partial)
    given = given_firmware(mine)
    assert given.name == "fw_mine:eyes"
    assert set(given.files) == {"fw_mine.py", *given_firmware(plain).files}
    assert given_firmware(replace(mine)).name.endswith(":(unnamed)")


def test_cells_of_a_notebook_are_its_source(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They have no file; their texts make the digest, whatever IPython calls them, with what they import."""

    def run_cell(name: str, text: str) -> Firmware:
        linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
        notebook = ModuleType("__main__")
        monkeypatch.setitem(sys.modules, "__main__", notebook)
        exec(compile(text, name, "exec"), vars(notebook))
        firmware = notebook.eyes
        assert isinstance(firmware, Firmware)
        return firmware

    text = f"import fw_pack.sizes\n{FIRMWARE}"
    given = given_firmware(run_cell("<cell 1>", text))
    assert (given.name, str(given.path)) == ("__main__:eyes", "(a notebook)")
    assert given.files == (
        CELL,
        "fw_pack/__init__.py",
        "fw_pack/more.py",
        "fw_pack/parts.py",
        "fw_pack/sizes.py",
    )
    assert given_firmware(run_cell("<cell 7>", text)).digest == given.digest
    assert given_firmware(run_cell("<cell 1>", text.replace("> 100", "> 101"))).digest != given.digest
    recording = record(folder / "drive.mcap", 1)
    assert simulate(recording, firmware=run_cell("<cell 1>", text)).identity.firmware_digest == given.digest


def test_a_script_that_runs_itself_is_named_after_its_file(folder: Path) -> None:
    """As with `--firmware FILE.py:NAME`."""
    recording = record(folder / "drive.mcap", 1)
    script = FIRMWARE + (
        "from pathlib import Path\nfrom bfsim.run import simulate\n"
        f"identity = simulate(Path({str(recording)!r}), firmware=eyes).identity\n"
        "print(identity.firmware, *identity.firmware_files, identity.firmware_digest)\n"
    )
    (folder / "fw_script.py").write_text(script)
    command = [sys.executable, "fw_script.py"]
    printed = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    assert printed.split()[:2] == ["fw_script:eyes", "fw_script.py"]
