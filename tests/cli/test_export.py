"""`bfsim export`: kernels as C, for people."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.errors import ConfigError
from tests.eyes import FIRMWARE
from tests.kernel.host_c import COMPILER, STRICT, needs_compiler
from tests.sums import SUMS

NO_KERNEL = """
from bfsim.api import *

def main(core):
    yield from core.next_frame()

def buffers(size):
    return {each: [Buffer("camera", u8, 2 * size.width_px, "sdram_bank0", rows=size.height_px)] for each in "AB"}

firmware = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=())
"""
"""Firmware that runs no kernel."""


def ran(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(main, ["export", *map(str, arguments)])
    return result.exit_code, result.output


@pytest.mark.exhaustive
@needs_compiler
def test_the_built_in_firmware_compiles_without_a_warning(tmp_path: Path) -> None:
    """Every kernel of the firmware, as C99, by this machine's compiler."""
    code, output = ran("tinyphoon", tmp_path / "c")
    assert code == 0
    assert "kernels" in output
    sources = sorted((tmp_path / "c").glob("*.c"))
    assert {"edge_detection.c", "circle_fit.c"} < {each.name for each in sources}
    command = [COMPILER, *STRICT, "-O1", "-fsyntax-only", *map(str, sources)]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.fixture
def eyes(tmp_path: Path) -> str:
    """Firmware of one kernel."""
    file = tmp_path / "fw_eyes.py"
    file.write_text(FIRMWARE)
    return f"{file}:eyes"


def test_nothing_is_left_where_there_is_no_room(
    eyes: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half of the files would look like all of them; a folder that was there before stays."""

    def full(path: Path, text: str) -> None:
        if path.name == "Makefile":
            raise ConfigError(f"{path} must be writable: No space left on device")
        path.write_text(text)

    monkeypatch.setattr("bfsim.exporting.write_text", full)
    (tmp_path / "old").mkdir()
    for folder, is_left in (("c", False), ("old", True)):
        code, output = ran(eyes, tmp_path / folder)
        assert code == 2
        assert "Makefile must be writable: No space left on device" in output
        assert (tmp_path / folder).exists() == is_left


def test_nothing_is_overwritten_unless_asked(eyes: str, tmp_path: Path) -> None:
    """A second export stops before it writes; --force writes."""
    folder = tmp_path / "c"
    code, output = ran(eyes, folder)
    assert code == 0
    assert output.startswith("1 kernel, ")
    (folder / "kernels.h").write_text("mine")
    code, output = ran(eyes, folder)
    assert code == 2
    assert "--force" in output
    assert (folder / "kernels.h").read_text() == "mine"
    assert ran(eyes, folder, "--force")[0] == 0
    assert (folder / "kernels.h").read_text() != "mine"


def test_kernels_of_other_languages_are_left_out(tmp_path: Path) -> None:
    """Object code is no Python to be written as C: it ended with a traceback."""
    (tmp_path / "fw_two.py").write_text(f"{FIRMWARE}\n{SUMS}")
    code, output = ran(f"{tmp_path}/fw_two.py:eyes", tmp_path / "c")
    assert (code, output.splitlines()[1]) == (
        0,
        "Left out, for they are not written in Python: sums (sums.c)",
    )
    assert "threshold" in (tmp_path / "c" / "kernels.h").read_text()
    assert "sums" not in (tmp_path / "c" / "kernels.h").read_text()


@pytest.mark.parametrize(
    ("kernels", "has"),
    [(SUMS, r"only sums \(sums\.c\), in another language"), ("", "none")],
    ids=["in C", "none"],
)
def test_firmware_without_kernels_in_python_is_told_what_it_has(
    tmp_path: Path, kernels: str, has: str
) -> None:
    """It pointed to `bfsim explain`, which has nothing to say of it."""
    (tmp_path / "fw_c.py").write_text(f"{NO_KERNEL}\n{kernels}")
    code, output = ran(f"{tmp_path}/fw_c.py", tmp_path / "c")
    assert code == 2
    assert re.search(f"must have kernels in Python to be exported as C, and has {has}", output)
    assert not (tmp_path / "c").exists()


def test_a_file_is_no_folder(eyes: str, tmp_path: Path) -> None:
    """It said that the file must be writable, which it was."""
    (tmp_path / "c").write_text("mine")
    code, output = ran(eyes, tmp_path / "c")
    assert code == 2
    assert "c must be a folder to write the files of C to, not a file" in output
    assert (tmp_path / "c").read_text() == "mine"


@pytest.mark.parametrize("wrong", ["nosuch", "nosuch.py:firmware"])
def test_firmware_that_is_not_there_is_named(wrong: str, tmp_path: Path) -> None:
    """The mistake is told, and no folder is made."""
    code, output = ran(wrong, tmp_path / "c")
    assert code == 2
    assert "nosuch" in output
    assert not (tmp_path / "c").exists()


def test_a_file_in_the_folder_s_place(eyes: str, tmp_path: Path) -> None:
    """A folder cannot be made where a file lies."""
    (tmp_path / "c").write_text("")
    code, output = ran(eyes, tmp_path / "c")
    assert code == 2
    assert "must be" in output
