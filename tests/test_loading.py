"""Firmware by its name: found in the current folder, and every way in which it cannot be found or imported."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bfsim.errors import FirmwareError, KernelError
from bfsim.loading import load_firmware

GOOD = """\
from bfsim.api import *

def main(core):
    while (yield from core.next_frame()) is not None:
        pass

fw = Firmware(mains={"A": main, "B": main}, buffers=lambda size: {}, camera="camera", rows=())
"""

Write = Callable[[str, str], Path]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Write]:
    """Write a file of a firmware into the current folder; what was imported from there is forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", sys.path[:])
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    before = set(sys.modules)

    def write_file(name: str, text: str) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    yield write_file
    for name in set(sys.modules) - before:
        if name.partition(".")[0].startswith("fw_"):
            del sys.modules[name]


def test_a_module_of_the_current_folder_is_found(write: Write) -> None:
    """PACKAGE:NAME is a module and what it calls its firmware."""
    write("fw_good.py", GOOD)
    loaded = load_firmware("fw_good:fw")
    assert loaded.name == "fw_good:fw"
    assert loaded.firmware.camera == "camera"


def test_a_module_in_a_package_is_found(write: Write) -> None:
    """Dots lead into packages."""
    write("fw_robot/__init__.py", "")
    write("fw_robot/eyes.py", GOOD)
    assert load_firmware("fw_robot.eyes:fw").firmware.camera == "camera"


@pytest.mark.parametrize(
    "name", ["", ":", "fw_good", "fw_good:", ":fw", "fw_good.py:", "a/b:fw", "..fw_good:fw", "a:b:c"]
)
def test_what_is_no_package_and_name_is_refused(name: str) -> None:
    """Nothing is imported for it."""
    with pytest.raises(
        FirmwareError, match="--firmware must be PACKAGE:NAME, such as tinyphoon:tinyphoon, not '"
    ):
        load_firmware(name)


@pytest.mark.parametrize(
    "name", ["fw_missing:fw", "fw_missing.eyes:fw", "fw_here.missing:fw", "fw_here.py:fw"]
)
def test_a_missing_package_is_told_where_it_should_be(write: Write, tmp_path: Path, name: str) -> None:
    """The folder that was searched stands in the message."""
    write("fw_here.py", GOOD)
    package = name.partition(":")[0]
    with pytest.raises(FirmwareError) as caught:
        load_firmware(name)
    assert str(caught.value) == (
        f"--firmware: the package '{package}' must be installed or in the folder {tmp_path}, but there is none"
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import json\nimport fw_nothing\n", "ModuleNotFoundError: No module named 'fw_nothing'"),
        ("import json\nimport fw_broken.part\n", "ModuleNotFoundError: No module named 'fw_broken.part'"),
        ("import json\nfrom json import nothing\n", "ImportError: cannot import name 'nothing' from 'json'"),
        ("import json\ndef main(core:\n", "SyntaxError: "),
        ("import json\n1 / 0\n", "ZeroDivisionError: division by zero"),
        ("import json\nraise SystemExit(3)\n", "SystemExit: 3"),
        ("from bfsim.api import *\nBuffer('line')\n", "TypeError: "),
        (
            "from bfsim.api import *\nImage = u8[:, :]\n",
            "TypeError: an array type must be written u8[:]: one ",
        ),
    ],
)
def test_an_error_while_importing_is_told_with_its_line(write: Write, text: str, message: str) -> None:
    """What Python said, and file and line of the firmware where it said so: line 2 in every case."""
    path = write("fw_broken/__init__.py", text)
    with pytest.raises(FirmwareError) as caught:
        load_firmware("fw_broken:fw")
    assert str(caught.value).startswith(f"--firmware: importing fw_broken failed with {message}")
    assert str(caught.value).endswith(f"({path}:2)")


def test_an_error_in_a_module_of_the_firmware_names_that_module(write: Write) -> None:
    """The file is the one with the mistake, not the one that imports it."""
    write("fw_deep/__init__.py", "from fw_deep import stage\n")
    stage = write("fw_deep/stage.py", "\n\nlines = [][0]\n")
    with pytest.raises(
        FirmwareError, match=r"importing fw_deep failed with IndexError: .* \(.*stage\.py:3\)$"
    ) as caught:
        load_firmware("fw_deep:fw")
    assert str(stage) in str(caught.value)


def test_a_refused_kernel_stays_a_kernel_error(write: Write) -> None:
    """It has file, line and caret already."""
    path = write("fw_kernel.py", "from bfsim.api import *\n@kernel\ndef k(a: u8[:]):\n    print(a)\n")
    with pytest.raises(KernelError, match=f"{path}:4"):
        load_firmware("fw_kernel:fw")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("fw_good:missing", "missing"),
        ("fw_good:main", "a function"),
        ("fw_good:Firmware", "a type"),
        ("sys:path", "a list"),
    ],
)
def test_what_is_no_firmware_is_told(write: Write, name: str, found: str) -> None:
    """The attribute, what it must be and what it is; also for modules that have no file."""
    write("fw_good.py", GOOD)
    attribute = name.partition(":")[2]
    with pytest.raises(FirmwareError, match=f"{attribute} must be a bfsim.api.Firmware, but is {found} "):
        load_firmware(name)


def test_a_folder_without_code_is_no_firmware(write: Write, tmp_path: Path) -> None:
    """Python imports any folder as an empty package; there is nothing in it."""
    (tmp_path / "fw_folder").mkdir()
    with pytest.raises(FirmwareError, match="fw must be a bfsim.api.Firmware, but is missing"):
        load_firmware("fw_folder:fw")


def digest_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Digest of the firmware fw_robot as it stands in `folder`."""
    for name in [each for each in sys.modules if each.startswith("fw_")]:
        del sys.modules[name]
    monkeypatch.setattr(sys, "path", [each for each in sys.path if "fw_home" not in each])
    monkeypatch.chdir(folder)
    return load_firmware("fw_robot:fw").digest


def test_the_digest_is_of_the_sources_wherever_they_are(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same in another folder, another one after a change in any module of the package."""
    for home in ("fw_home_1", "fw_home_2"):
        write(f"{home}/fw_robot/__init__.py", "from fw_robot import eyes\n" + GOOD)
        write(f"{home}/fw_robot/eyes.py", "focal_px = 300\n")
    first = digest_in(tmp_path / "fw_home_1", monkeypatch)
    assert digest_in(tmp_path / "fw_home_2", monkeypatch) == first
    write("fw_home_2/fw_robot/eyes.py", "focal_px = 301\n")
    assert digest_in(tmp_path / "fw_home_2", monkeypatch) != first
