"""Firmware by its name: which files it is, how it follows their edits, and every way in which it cannot be imported."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

import pytest

from bfsim import shipped
from bfsim.errors import FirmwareError, KernelError
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernel_named import load_kernel
from tests.commands import started
from tests.eyes import FIRMWARE

GOOD = """\
from bfsim.api import *

def main(core):
    while (yield from core.next_frame()) is not None:
        pass

fw = Firmware(mains={"A": main, "B": main}, buffers=lambda size: {}, camera="camera", rows=())
"""

Write = Callable[[str, str], Path]


@pytest.fixture(autouse=True)
def untouched() -> Iterator[None]:
    """Whatever is loaded, Python's path and modules are afterwards as they were."""
    path, modules, finders = sys.path[:], dict(sys.modules), sys.meta_path[:]
    yield
    assert (sys.path, sys.meta_path) == (path, finders)
    new = {name for name, module in sys.modules.items() if modules.get(name) is not module}
    assert not {name for name in new if name.startswith(("fw_", "tinyphoon"))}


def named(text: str) -> str:
    """Firmware that is told by the name of its camera buffer."""
    return GOOD.replace('"camera"', f'"{text}"')


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


def test_built_in_firmware_is_called_by_its_name_alone() -> None:
    """Its files are those that are shipped."""
    for name in shipped.FIRMWARE:
        loaded = load_firmware(name)
        assert (loaded.name, loaded.is_built_in) == (name, True)
        assert loaded.path == shipped.FIRMWARE_FOLDER / "tinyphoon" / "__init__.py"
        there = {
            each.relative_to(shipped.FIRMWARE_FOLDER).as_posix() for each in loaded.path.parent.rglob("*.py")
        }
        assert {"tinyphoon/core_a.py", "tinyphoon/stages/edge_detection.py"} < set(loaded.files) <= there


@pytest.mark.parametrize("own", ["firmware/__init__.py", "firmware.py", "firmware/fw_part.py"])
def test_a_firmware_folder_of_the_users_own_is_the_one_that_runs(write: Write, own: str) -> None:
    """The most usual name; what is built in is not met by it."""
    path = write(own, named("mine"))
    package = own.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    loaded = load_firmware(f"{package}:fw")
    assert (loaded.firmware.camera, loaded.path, loaded.files) == ("mine", path, (own,))


def test_what_is_shipped_neither_shadows_nor_is_shadowed(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A package of the same name in the current folder, or on Python's path, is another one; in one process, too."""
    write("tinyphoon/__init__.py", GOOD + "tinyphoon = fast = thesis = rectified_features = one_eye = fw\n")
    write("elsewhere/tinyphoon/__init__.py", named("elsewhere") + "tinyphoon = fw\n")
    monkeypatch.syspath_prepend(tmp_path / "elsewhere")
    for _ in range(2):
        assert load_firmware("tinyphoon").path.parent.parent == shipped.FIRMWARE_FOLDER
        assert load_firmware("tinyphoon:tinyphoon").path == tmp_path / "tinyphoon" / "__init__.py"
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert load_firmware("tinyphoon:tinyphoon").firmware.camera == "elsewhere"
    assert load_firmware("one_eye").path.parent.parent == shipped.FIRMWARE_FOLDER


def test_firmware_in_a_file_is_found_in_any_folder(write: Write, tmp_path: Path) -> None:
    """With the modules beside it; a file in a package has the package's name."""
    write("there/fw_part.py", "name = 'beside'\n")
    write("there/fw-2.py", "from fw_part import name\n" + GOOD.replace('"camera"', "name"))
    assert load_firmware("there/fw-2.py:fw").firmware.camera == "beside"
    assert load_firmware(f"{tmp_path}/there/fw-2.py").files == ("fw-2.py", "fw_part.py")
    write("there/fw_robot/__init__.py", "")
    write("there/fw_robot/eyes.py", "from . import __name__ as name\n" + GOOD.replace('"camera"', "name"))
    loaded = load_firmware("there/fw_robot/eyes.py:fw")
    assert (loaded.name, loaded.firmware.camera) == ("fw_robot.eyes:fw", "fw_robot")


def test_the_name_may_be_left_out_where_there_is_one(write: Write) -> None:
    """Of several, or none, it must be said which."""
    write("fw_good.py", GOOD)
    assert load_firmware("fw_good").name == load_firmware("fw_good.py").name == "fw_good:fw"
    write("fw_two.py", GOOD + "eyes = Firmware(mains={}, buffers=fw.buffers, camera='', rows=())\n")
    with pytest.raises(
        FirmwareError, match=r"fw_two.py must be followed by :NAME .*, but it has fw and eyes \("
    ):
        load_firmware("fw_two.py")
    write("fw_none.py", "")
    with pytest.raises(FirmwareError, match=r"fw_none must be followed by :NAME .*, but it has none \("):
        load_firmware("fw_none")


@pytest.mark.parametrize("edited", ["fw_robot/__init__.py", "fw_robot/eyes.py", "fw_beside.py"])
def test_an_edit_is_loaded_in_the_same_process(write: Write, tmp_path: Path, edited: str) -> None:
    """In any of its modules; also where neither the size of the file nor its time says so."""
    texts = {
        "fw_robot/__init__.py": "from fw_robot.eyes import name\n" + GOOD.replace('"camera"', "name + 'x'"),
        "fw_robot/eyes.py": "from fw_beside import name as _name\nname = _name + 'x'\n",
        "fw_beside.py": "name = 'x'\n",
    }
    for name, text in texts.items():
        write(name, text)
    first = load_firmware("fw_robot:fw")
    assert load_firmware("fw_robot:fw").firmware is first.firmware
    stat = (tmp_path / edited).stat()
    write(edited, texts[edited].replace("'x'", "'y'"))
    os.utime(tmp_path / edited, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    second = load_firmware("fw_robot:fw")
    assert sorted(first.firmware.camera + second.firmware.camera) == list("xxxxxy")
    assert first.digest != second.digest


def test_what_was_not_edited_is_not_compiled_again(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another process finds what Python made of the same bytes of the same file, and only of these."""
    compiled, real = list[bytes](), SourceFileLoader.source_to_code

    def noted(self: SourceFileLoader, data: bytes, path: str) -> CodeType:
        compiled.append(data)
        return real(self, data, path)

    monkeypatch.setattr(SourceFileLoader, "source_to_code", noted)
    for text in ("one", "one", "two"):
        monkeypatch.setattr("bfsim.loading.modules._imported", {})  # as another process would begin
        write("fw_again.py", named(text))
        assert load_firmware("fw_again:fw").firmware.camera == text
    assert compiled == [named(text).encode() for text in ("one", "two")]


def test_what_was_compiled_is_found_by_a_name_in_any_locale(write: Write, tmp_path: Path) -> None:
    """Python spells a name that is not ASCII in another way where the locale is: kernels read their source by it."""
    write("ruder_\xfc/eyes.py", FIRMWARE)
    without_utf8 = {"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for environment in ({"LC_ALL": "C.UTF-8"}, without_utf8):
        done = started("explain", "ruder_\xfc/eyes.py:threshold", cwd=tmp_path, **environment)
        assert done.returncode == 0, done.stderr


def test_an_edited_kernel_is_the_one_that_is_compiled(write: Write, tmp_path: Path) -> None:
    """Kernels read their source from the file, which Python's cache of lines may have as it was."""
    text = "from bfsim.api import *\n@kernel\ndef fw_k() -> i32:\n    return 1\n"
    path = write("fw_kernel.py", text)
    assert load_kernel("fw_kernel:fw_k", "tinyphoon")() == 1
    stat = path.stat()
    write("fw_kernel.py", text.replace("1", "2"))
    os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert load_kernel("fw_kernel.py:fw_k", "tinyphoon")() == 2


def test_modules_that_somebody_else_imported_are_left_to_them(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module of the same name, from the same file or another one, is neither taken nor replaced."""
    write("fw_good.py", GOOD)
    other = ModuleType("fw_good")
    monkeypatch.setitem(sys.modules, "fw_good", other)
    assert load_firmware("fw_good:fw").firmware.camera == "camera"
    assert sys.modules["fw_good"] is other


def test_what_libraries_import_is_not_the_firmwares(write: Write) -> None:
    """A module beside the firmware that has the name of Python's, or of one that a library looks for."""
    write("types.py", "1 / 0\n")
    write("fw_library.py", "import importlib\ndef get(name): return importlib.import_module(name)\n")
    write("fw_good.py", "import types, fw_library\nfw_library.get('fw_late')\n" + GOOD)
    write("fw_late.py", "")
    assert load_firmware("fw_good:fw").files == ("fw_good.py", "fw_late.py", "fw_library.py")
    with pytest.raises(FirmwareError, match="types.py must have another name: types is a module of Python"):
        load_firmware("types.py:fw")
    write("numpy.py", GOOD)
    assert load_firmware("fw_good:fw").files == ("fw_good.py", "fw_late.py", "fw_library.py")
    with pytest.raises(
        FirmwareError, match="numpy.py must have another name: numpy is a module of .* what it needs"
    ):
        load_firmware("numpy.py:fw")


def test_built_in_firmware_can_be_built_on(write: Write) -> None:
    """Its files are then among those that run."""
    write(
        "fw_own.py",
        "from dataclasses import replace\nimport tinyphoon\nfw = replace(tinyphoon.tinyphoon, view=None)\n",
    )
    assert {"fw_own.py", "tinyphoon/core_a.py"} < set(load_firmware("fw_own.py").files)


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


def test_the_digest_is_of_the_sources_wherever_they_are(write: Write, tmp_path: Path) -> None:
    """The same in another folder, another one after a change in any module of the package."""
    for home in ("fw_home_1", "fw_home_2"):
        write(f"{home}/fw_robot/__init__.py", "from fw_robot import eyes\n" + GOOD)
        write(f"{home}/fw_robot/eyes.py", "focal_px = 300\n")
    first, second = (load_firmware(f"fw_home_{n}/fw_robot/__init__.py:fw") for n in (1, 2))
    assert (first.digest, first.files, first.name) == (second.digest, second.files, second.name)
    write("fw_home_2/fw_robot/eyes.py", "focal_px = 301\n")
    assert load_firmware("fw_home_2/fw_robot/__init__.py:fw").digest != first.digest


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
