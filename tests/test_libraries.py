"""Modules that firmware imports from elsewhere than its folder: an edit of one is another run, as an edit of the firmware is."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

import pytest

from bfsim.loading.firmware import load_firmware
from bfsim.run import simulate
from tests.eyes import FIRMWARE, record

USER = FIRMWARE.replace(
    "from bfsim.api import *", "from bfsim.api import *\nimport json, numpy\nfrom lib_eyes.rows import ROWS"
).replace("rows=2", "rows=ROWS")
LIBRARY = {
    "lib_eyes/__init__.py": "",
    "lib_eyes/rows.py": "from . import numbers\nimport lib_far\nROWS = numbers.TWO\n",
    "lib_eyes/numbers.py": "TWO = 2\n",
    "lib_eyes/unused.py": "",
    "lib_far.py": "",
    "site-packages/lib_installed.py": "",
}
FILES = ("fw_user.py", "lib_eyes/__init__.py", "lib_eyes/numbers.py", "lib_eyes/rows.py", "lib_far.py")


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on Python's path with a library; beside it, in the current folder, firmware that imports it."""
    folder, home = tmp_path / "library", tmp_path / "home"
    for name, text in LIBRARY.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    home.mkdir()
    (home / "fw_user.py").write_text(USER)
    monkeypatch.chdir(home)
    for each in (folder, folder / "site-packages", home):
        monkeypatch.syspath_prepend(each)
    yield folder
    forget()


def forget() -> None:
    """Have Python import all of it anew, as another process does."""
    for name in [each for each in sys.modules if each.startswith(("lib_", "fw_user"))]:
        del sys.modules[name]


def test_a_library_is_a_part_of_the_firmware(library: Path) -> None:
    """With what it imports, but not what is installed: a sweep told what it had kept from before the edit."""
    (library / "lib_far.py").write_text("import lib_installed\n")
    before = load_firmware("fw_user.py:eyes")
    assert before.files == FILES
    forget()
    (library / "lib_eyes/numbers.py").write_text("TWO = 1 + 1\n")
    (Path("other")).mkdir()
    (Path("other") / "fw_user.py").write_text(USER)
    after = load_firmware("other/fw_user.py:eyes")
    assert after.files == FILES
    assert after.digest != before.digest


def test_firmware_by_object_has_its_libraries_too(library: Path) -> None:
    """The identity is that of the same firmware by its name."""
    recording = record(library / "drive.mcap", 1)
    by_object = simulate(recording, firmware=import_module("fw_user").eyes)
    assert by_object.identity == simulate(recording, firmware="fw_user:eyes").identity
    assert by_object.identity.firmware_files == FILES
