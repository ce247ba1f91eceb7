"""Firmware by its name: which files it is, and how it follows their edits."""

from __future__ import annotations

import os
import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType

import pytest

from bfsim import shipped
from bfsim.errors import FirmwareError
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernel_named import load_kernel
from tests.commands import started
from tests.conftest import Write
from tests.eyes import FIRMWARE
from tests.loading.good_firmware import GOOD


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


def test_the_digest_is_of_the_sources_wherever_they_are(write: Write, tmp_path: Path) -> None:
    """The same in another folder, another one after a change in any module of the package."""
    for home in ("fw_home_1", "fw_home_2"):
        write(f"{home}/fw_robot/__init__.py", "from fw_robot import eyes\n" + GOOD)
        write(f"{home}/fw_robot/eyes.py", "focal_px = 300\n")
    first, second = (load_firmware(f"fw_home_{n}/fw_robot/__init__.py:fw") for n in (1, 2))
    assert (first.digest, first.files, first.name) == (second.digest, second.files, second.name)
    write("fw_home_2/fw_robot/eyes.py", "focal_px = 301\n")
    assert load_firmware("fw_home_2/fw_robot/__init__.py:fw").digest != first.digest
