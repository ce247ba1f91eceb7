"""Who compiled kernels that are in C is a part of a run: its cycles are those of that code. A stand-in compiles with another version."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

from bfsim.checking import require_comparable
from bfsim.errors import ConfigError, WorkError
from bfsim.report.check.baseline import Case, Configuration, measured_on
from bfsim.report.what_ran.code import code_in_words
from bfsim.run import simulate
from tests.eyes import record
from tests.sums import DATA

FIRMWARE = """
from bfsim.api import BudgetRow, Buffer, Firmware, i32, kernel_from, u8

sums = kernel_from("sums.c", "sums", row=u8[:], out=i32[:], n=i32, first=i32, result=i32)


def main(core):
    out = core.array("out")
    while (frame := (yield from core.next_frame())) is not None:
        lines, total = core.input_ring(frame.rows, "ring"), 0
        with core.stage("Sums"):
            for _ in frame.rows:
                total += yield core.run(sums, (yield from lines.line()), out, frame.width, 0)
        core.publish(total=total)


def buffers(size):
    line = 2 * size.width_px
    return {
        core: [
            Buffer("camera", u8, line, f"sdram_bank{number}", rows=3 * size.height_px),
            Buffer("ring", u8, line, "L1_data_a", rows=2),
            Buffer("out", i32, size.width_px, "L1_data_b"),
        ]
        for number, core in enumerate("AB")
    }


firmware = Firmware(mains={"A": main, "B": main}, buffers=buffers, camera="camera", rows=(BudgetRow(stage="Sums"),))
"""
COMPILER = """\
#!/bin/sh
case "$*" in
  *-dumpmachine) echo bfin-elf ;;
  *-dumpfullversion) echo {version} ;;
  *-o\\ kernels.o) cp {data}/sums.o kernels.o ;;
esac
"""


@pytest.fixture
def compiled_by(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """A folder with firmware whose kernel is in C, the current one, and what puts a compiler of a version on the PATH."""
    (tmp_path / "fw_sums.py").write_text(FIRMWARE)
    shutil.copy(DATA / "sums.c", tmp_path)
    record(tmp_path / "drive.mcap", 1)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))

    def compiled_by(version: str) -> None:
        program = tmp_path / version / "bfin-elf-gcc"
        program.parent.mkdir()
        program.write_text(COMPILER.format(version=version, data=DATA))
        program.chmod(0o755)
        monkeypatch.setenv("PATH", f"{program.parent}:/bin:/usr/bin")
        shutil.copy("fw_sums.py", f"fw_{version[:2]}.py")  # what was imported is not imported again

    return compiled_by


@pytest.mark.parametrize("profile", ["gcc-adi", "gcc-O2"])
def test_runs_of_other_compilers_are_other_runs(compiled_by: Callable[[str], None], profile: str) -> None:
    """Their identities were the same: a sweep kept the cycles of the one for the other, and recorded work was played for it."""
    runs = []
    for version in ("11.4.0", "12.2.0"):
        compiled_by(version)
        runs.append(simulate("drive.mcap", firmware=f"fw_{version[:2]}.py:firmware", profile=profile))
    assert [each.identity.file_compiler for each in runs] == ["GCC 11.4.0", "GCC 12.2.0"]
    assert [each.identity.code for each in runs] == ["", ""]
    assert code_in_words(runs[0]) == "object code of files, GCC 11.4.0"


def test_limits_of_another_compiler_are_refused(compiled_by: Callable[[str], None]) -> None:
    """As they are of kernels in Python, by its version; an edit of the C is other code of the same compiler."""
    compiled_by("11.4.0")
    what = Configuration(recording="drive.mcap", firmware="fw_sums.py")
    on = measured_on(simulate("drive.mcap", firmware="fw_sums.py:firmware").identity, 1)
    case = Case(name="drive", measured_on=on, **dict(what))
    require_comparable(case, Path("limits.toml"))
    Path("sums.c").write_text(Path("sums.c").read_text() + "\n")
    require_comparable(case, Path("limits.toml"))
    compiled_by("12.2.0")
    Path("sums.c").write_text(Path("sums.c").read_text() + "\n")
    with pytest.raises(
        ConfigError,
        match="run 'drive': kernels in C were compiled by 'GCC 11.4.0' when the limits were measured, and are by 'GCC 12.2.0'",
    ):
        require_comparable(case, Path("limits.toml"))


def test_work_of_another_compiler_is_refused(compiled_by: Callable[[str], None]) -> None:
    """Its accesses and cycles are those of the code that was recorded."""
    compiled_by("11.4.0")
    simulate("drive.mcap", firmware="fw_sums.py:firmware", record_work="drive.work")
    compiled_by("12.2.0")
    Path("fw_sums.py").touch()
    Path("sums.c").write_text(Path("sums.c").read_text() + "\n")
    with pytest.raises(
        WorkError, match="with the same compiler of kernels in C, 'GCC 12.2.0', not with 'GCC 11.4.0'"
    ):
        simulate("drive.mcap", firmware="fw_sums.py:firmware", work="drive.work")


def test_firmware_by_object_has_its_c_in_its_identity(
    compiled_by: Callable[[str], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by its name; that of the C was missing, so that an edit of it changed no digest."""
    compiled_by("11.4.0")
    monkeypatch.syspath_prepend(tmp_path)
    by_object = simulate("drive.mcap", firmware=import_module("fw_sums").firmware)
    assert by_object.identity == simulate("drive.mcap", firmware="fw_sums:firmware").identity
    assert by_object.identity.firmware_files == ("fw_sums.py", "sums.c")
