"""Kernels from C that is compiled: with what it includes, of several files, and its lines."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from bfsim.api import f32, i32, kernel_from
from bfsim.compiling import file_code
from bfsim.errors import ConfigError, KernelError
from bfsim.kernel import GCC_O2
from bfsim.kernel.objects.sources import file_lines
from tests.sums import sums


def test_a_source_needs_a_compiler_or_kept_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What would be compiled by what, and how one gets it."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(file_code, "blackfin_compiler", lambda: None)
    (tmp_path / "sums.c").write_text("int sums(void) { return 1; }")
    with pytest.raises(
        ConfigError,
        match="bfin-elf-gcc must be on the PATH to compile sums.c, of which no code of GCC 12.2.0 is kept",
    ):
        sums(tmp_path, "sums.c")


@pytest.mark.toolchain
def test_several_files_are_one_object_file(tmp_path: Path) -> None:
    """By the command of docs/how-to/c-and-assembler.md; what either lacks by itself is told with its line."""
    (tmp_path / "drive.c").write_text("int steered(int a)\n{\n    return a / 3;\n}\n")
    (tmp_path / "ball.c").write_text("int steered(int);\nint ball(int a)\n{\n    return steered(a) + 1;\n}\n")
    command = "bfin-elf-gcc -O2 -g -r -nostdlib -o robot.o drive.c ball.c -lm -lc -lgcc"
    subprocess.run(command.split(), cwd=tmp_path, check=True)
    kernel = kernel_from(tmp_path / "robot.o", "ball", a=i32, result=i32)
    assert kernel(42) == 42 // 3 + 1
    sources = {each.name: each.file for each in kernel.compile(GCC_O2).functions}
    assert sources.items() >= {"ball": f"{tmp_path}/ball.c", "steered": f"{tmp_path}/drive.c"}.items()
    alone = kernel_from(tmp_path / "ball.c", "ball", a=i32, result=i32)
    with pytest.raises(KernelError, match="steered, which ball.c does not define and ball calls at ball.c:4"):
        alone(42)


@pytest.mark.toolchain
def test_c_is_compiled_with_what_it_includes(tmp_path: Path) -> None:
    """A changed header is another code, a float comes back as one, and a library's function is shown beside the own ones."""
    (tmp_path / "half.c").write_text('#include "part.h"\nfloat half(float a) { return PART * a; }\n')
    for part in (0.5, 0.25):
        (tmp_path / "part.h").write_text(f"#define PART {part}f\n")
        kernel = kernel_from(tmp_path / "half.c", "half", a=f32, result=f32)
        assert kernel(6.0) == 6 * part
    assert {"half", "__mulsf3"} <= {each.name for each in kernel.compile(GCC_O2).functions}


@pytest.mark.toolchain
def test_what_is_included_may_be_in_other_folders(tmp_path: Path) -> None:
    """Above and below the file; its lines are shown, but not those of one of two files with one name."""
    for file, text in {
        "own/third.c": '#include "../all/deep/part.h"\n#include "part.h"\nint third(int a) { return deep(a) + part(a); }\n',
        "own/part.h": "static __attribute__((noinline)) int part(int a) { return a * a; }\n",
        "all/deep/part.h": '#include "../base.h"\nstatic int deep(int a) { return base(a) + 1; }\n',
        "all/base.h": "static __attribute__((noinline)) int base(int a) { return 3 * a; }\n",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    kernel = kernel_from(tmp_path / "own/third.c", "third", a=i32, result=i32)
    assert kernel(4) == 3 * 4 + 1 + 4 * 4
    sources = {each.name: each.source for each in kernel.compile(GCC_O2).functions}
    assert "return 3 * a" in sources["base"]
    assert "a * a" not in sources["part"]
    assert "R0" in sources["part"]


INCLUDING = {
    "file.c": '#include "{there}/part.h"\nint part(int a) {{ return PART * a; }}\n',
    "marked.c": '\ufeff#include "part.h"\nint part(int a) {{ return PART * a; }}\n',
    "file.s": '.include "part.inc"\n.global _part\n.type _part, STT_FUNC\n_part:\n times_part;\nRTS;\n.size _part, .-_part\n',
}


@pytest.mark.toolchain
@pytest.mark.parametrize("file", INCLUDING)
def test_what_is_included_is_a_part_of_the_code_however_it_is_named(file: str, tmp_path: Path) -> None:
    """By the name of a place, whose changes were not seen; behind a byte order mark, and by the assembler, which found nothing."""
    (tmp_path / file).write_text(INCLUDING[file].format(there=tmp_path), encoding="utf-8")
    for part, code in ((2, "R0 = R0 + R0"), (3, "R1 = R0 << 1; R0 = R0 + R1")):
        (tmp_path / "part.h").write_text(f"#define PART {part}\n")
        (tmp_path / "part.inc").write_text(f".macro times_part\n{code};\n.endm\n")
        assert kernel_from(tmp_path / file, "part", a=i32, result=i32)(7) == 7 * part
        assert (tmp_path / "part.h").read_text() == f"#define PART {part}\n"


@pytest.mark.toolchain
def test_a_compiler_sees_the_bytes_of_the_file(tmp_path: Path) -> None:
    """Old C is in Latin-1: a letter beyond ASCII had three bytes, and others than in the file."""
    text = 'static const unsigned char name[] = "\xfc";\nint letter(int a) { return 1000 * sizeof name + name[a]; }\n'
    (tmp_path / "old.c").write_bytes(text.encode("latin-1"))
    assert kernel_from(tmp_path / "old.c", "letter", a=i32, result=i32)(0) == 2000 + 0xFC


def test_lines_of_a_source_are_counted_as_a_compiler_counts_them(tmp_path: Path) -> None:
    """Sources of GNU have form feeds between their parts, which end no line for a compiler."""
    (tmp_path / "parts.c").write_bytes(b"int a;\n\f\nint b; /* \x85 \v */\r\nint c;\n")
    assert file_lines(tmp_path / "parts.c") == [
        "int a;",
        "\f",
        "int b; /* \N{REPLACEMENT CHARACTER} \v */",
        "int c;",
    ]
