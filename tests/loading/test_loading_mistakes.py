"""Every way in which firmware cannot be imported is told with the file and the line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from bfsim.errors import FirmwareError, KernelError
from bfsim.loading.firmware import load_firmware
from tests.conftest import Write
from tests.loading.good_firmware import GOOD


@pytest.mark.parametrize("name", ["", ":", "fw_good:", ":fw", "a/b:fw", "..fw_good:fw", "a:b:c"])
def test_what_is_no_package_and_name_is_refused(name: str) -> None:
    """Nothing is imported for it."""
    with pytest.raises(
        FirmwareError,
        match="--firmware must be one of tinyphoon, fast, thesis, rectified_features, one_eye, FILE.py:NAME or PACKAGE:NAME, not '",
    ):
        load_firmware(name)


def test_a_missing_package_is_told_where_it_should_be(write: Write, tmp_path: Path) -> None:
    """The folder that was searched stands in the message, and how what is built in is written."""
    write("fw_here.py", GOOD)
    for name, advice in (
        ("fw_missing:fw", "built in are tinyphoon, fast, thesis, rectified_features and one_eye"),
        ("fw_missing", "built in are tinyphoon, fast, thesis, rectified_features and one_eye"),
        ("fw_missing:tinyphoon", "the built-in firmware is written tinyphoon"),
    ):
        with pytest.raises(FirmwareError) as caught:
            load_firmware(name)
        assert str(caught.value) == (
            f"the package 'fw_missing' must be installed or in the folder {tmp_path}, but there is none; {advice}"
        )
    with pytest.raises(
        FirmwareError, match=f"the module 'fw_here.missing' must be in {tmp_path}, but there is none"
    ):
        load_firmware("fw_here.missing:fw")
    with pytest.raises(FirmwareError, match="fw_there.py must be a file, but there is none"):
        load_firmware("fw_there.py:fw")
    write("drive.mcap", "")
    with pytest.raises(
        FirmwareError, match=r"drive\.mcap must be a file \*\.py or a package, but is another file"
    ):
        load_firmware("drive.mcap")
    (tmp_path / "firmware").mkdir()
    with pytest.raises(FirmwareError, match="but is missing .*; the built-in firmware is written one_eye"):
        load_firmware("firmware:one_eye")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import json\nimport fw_nothing\n", "ModuleNotFoundError: No module named 'fw_nothing'"),
        ("import json\nimport fw_broken.part\n", "ModuleNotFoundError: No module named 'fw_broken.part'"),
        ("import json\nfrom json import nothing\n", "ImportError: cannot import name 'nothing' from 'json'"),
        ("import json\n1 / 0\n", "ZeroDivisionError: division by zero"),
        ("import json\nraise SystemExit(3)\n", "SystemExit: 3"),
        ("from bfsim.api import *\nBuffer('line')\n", "TypeError: "),
        (
            "from bfsim.api import *\nImage = u8[:, :]\n",
            "TypeError: an array type must be written u8[:]: one dimension, no size: a[y * width + x]",
        ),
    ],
)
def test_an_error_while_importing_is_told_with_its_line(write: Write, text: str, message: str) -> None:
    """What Python said, and file and line of the firmware where it said so: line 2 in every case."""
    path = write("fw_broken/__init__.py", text)
    with pytest.raises(FirmwareError) as caught:
        load_firmware("fw_broken:fw")
    assert str(caught.value).startswith(f"importing fw_broken failed with {message}")
    assert str(caught.value).endswith(f"({path}:2)")


@pytest.mark.parametrize(
    ("text", "said", "marked"),
    [
        ("    def main(core)\n", "expected ':'", "    def main(core)\n                      ^"),
        ("\t(1, 2\n", "'(' was never closed", "\t(1, 2\n    \t^"),
    ],
)
def test_what_python_cannot_read_is_shown_with_a_caret(
    write: Write, text: str, said: str, marked: str
) -> None:
    """As what the kernel language refuses is; the line had its number twice and was not shown."""
    path = write("fw_unread.py", f"if True:\n{text}")
    with pytest.raises(FirmwareError) as caught:
        load_firmware("fw_unread.py")
    assert (
        str(caught.value) == f"importing fw_unread failed with SyntaxError: {said} ({path}:2)\n    {marked}"
    )


def test_a_failure_without_words_shows_its_line(write: Write) -> None:
    """`AssertionError: ` was all that was said."""
    path = write("fw_sure.py", "ROWS = 3\nassert ROWS > 3\n")
    with pytest.raises(
        FirmwareError, match=r"failed with AssertionError: assert ROWS > 3 \(.*fw_sure\.py:2\)$"
    ):
        load_firmware("fw_sure.py")
    path.write_text("raise ValueError(\n)\n")
    with pytest.raises(FirmwareError, match=r"failed with ValueError: raise ValueError\("):
        load_firmware("fw_sure.py")


def test_a_file_of_another_kind_is_told_beside_a_module_of_its_name(write: Write) -> None:
    """`line.txt` was looked for as the module txt in the package line, and was said not to be there."""
    write("fw_line.py", GOOD)
    write("fw_line.txt", GOOD)
    with pytest.raises(
        FirmwareError, match=r"fw_line\.txt must be a file \*\.py or a package, but is another"
    ):
        load_firmware("fw_line.txt")


def test_a_file_that_is_no_text_has_no_line(write: Write) -> None:
    """As one that an editor saved as UTF-16: `(None:None)` stood behind it."""
    write("fw_wide.py", "import json\n\0")
    with pytest.raises(
        FirmwareError,
        match=r"importing fw_wide failed with (SyntaxError|ValueError): source code .* null bytes$",  # Python 3.11.2 calls it a value
    ):
        load_firmware("fw_wide.py:fw")


def test_an_error_in_a_module_of_the_firmware_names_that_module(write: Write) -> None:
    """The file is the one with the mistake, not the one that imports it."""
    write("fw_deep/__init__.py", "from fw_deep import stage\n")
    stage = write("fw_deep/stage.py", "\n\nlines = [][0]\n")
    with pytest.raises(
        FirmwareError, match=r"importing fw_deep failed with IndexError: .* \(.*stage\.py:3\)$"
    ) as caught:
        load_firmware("fw_deep:fw")
    assert str(stage) in str(caught.value)


@pytest.mark.parametrize("marked", ["@kernel()\ndef f(x: i32): pass", "@kernel\nclass F: pass"])
def test_a_refusal_without_a_place_gets_that_of_its_line(write: Write, marked: str) -> None:
    """What is no function has no source to show, but stands in a line of a file; a refusal with a place has it once."""
    path = write("fw_marked.py", f"from bfsim.api import *\n{marked}\n")
    with pytest.raises(KernelError, match=rf"^@kernel must stand .* \({re.escape(str(path))}:\d\)$"):
        load_firmware("fw_marked:it")
    path.write_text("from bfsim.api import *\n@kernel\ndef f(x: i32):\n    y = [x]\n")
    with pytest.raises(KernelError) as caught:
        load_firmware("fw_marked:it")
    assert str(caught.value).count(str(path)) == 1


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
    ],
)
def test_what_is_no_firmware_is_told(write: Write, name: str, found: str) -> None:
    """The attribute, what it must be and what it is."""
    write("fw_good.py", GOOD)
    attribute = name.partition(":")[2]
    with pytest.raises(FirmwareError, match=f"{attribute} must be a bfsim.api.Firmware, but is {found} "):
        load_firmware(name)


def test_a_folder_without_code_is_no_firmware(write: Write, tmp_path: Path) -> None:
    """Python imports any folder as an empty package; there is nothing in it."""
    (tmp_path / "fw_folder").mkdir()
    with pytest.raises(FirmwareError, match="fw must be a bfsim.api.Firmware, but is missing"):
        load_firmware("fw_folder:fw")


@pytest.mark.parametrize(
    "name", ["x" * 9_000, "x" * 9_000 + ":fw", "x" * 9_000 + ".py:fw", "x" * 300 + ".py", ":" * 9_000]
)
def test_long_names_are_cut(name: str) -> None:
    """A message is one that can be read."""
    with pytest.raises(FirmwareError) as caught:
        load_firmware(name)
    assert len(str(caught.value)) < 1_000


def test_an_error_leaves_nothing_half_imported(write: Write) -> None:
    """What is mended is imported anew, with all that was whole."""
    write("fw_robot/__init__.py", "import fw_robot.whole, fw_robot.broken\n" + GOOD)
    write("fw_robot/whole.py", "")
    write("fw_robot/broken.py", "1 / 0\n")
    with pytest.raises(FirmwareError, match="ZeroDivisionError"):
        load_firmware("fw_robot:fw")
    write("fw_robot/broken.py", "")
    assert len(load_firmware("fw_robot:fw").files) == 3
