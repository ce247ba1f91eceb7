"""What is known of a kernel's text is kept, and used only where all that decided how it was understood is the same."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest

from bfsim.errors import KernelError
from bfsim.kernel import VDSP_O2
from bfsim.kernel.language import language, source_files
from bfsim.kernel.language.tree import body_of
from tests.kernel.modules import import_text

TEXT = """
SHIFT = 2

@kernel
def part(x: i32) -> i32:
    return x >> SHIFT

@kernel
def whole(row: u8[:], by: i32):
    row[0] = part(by)
"""


@pytest.fixture(autouse=True)
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """List the kernels that are really read, with an empty cache at first."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    found: list[str] = []
    real = language.read_definition

    def noted(source: object, outer: object, python: object) -> object:
        found.append(python.__name__)  # type: ignore[attr-defined]
        return real(source, outer, python)  # type: ignore[arg-type]

    monkeypatch.setattr(language, "read_definition", noted)
    return found


def result_of(text: str, folder: Path) -> int:
    """Import the text, run `whole` on 40, and return what it stores."""
    row = np.zeros(1, np.uint8)
    import_text(text, folder, "same").whole(row, 40)
    return int(row[0])


def test_a_kernel_is_read_once_and_its_body_when_it_is_compiled(read: list[str], tmp_path: Path) -> None:
    """What everybody asks of a kernel is kept; a start that compiles nothing reads nothing."""
    first = import_text(TEXT, tmp_path, "same").whole.function
    assert read == ["part", "whole"]
    again = import_text(TEXT, tmp_path, "same").whole.function
    assert read == ["part", "whole"]
    for name in ("name", "symbol", "source", "parameters", "result", "is_static", "written", "digest"):
        assert getattr(first, name) == getattr(again, name)
    assert [each.name for each in again.callees()] == ["part"]
    assert read == ["part", "whole"]
    body, other = body_of(again), body_of(first)
    assert (body.locals, len(body.block)) == (other.locals, len(other.block))
    assert read == ["part", "whole", "whole"]


@pytest.mark.parametrize(
    ("old", "new", "result", "anew"),
    [
        ("SHIFT = 2", "SHIFT = 0x3", 5, ["part"]),
        ("SHIFT = 2", "SHIFT = 2  # bits", 10, []),
        ("x >> SHIFT", "x << SHIFT", 160, ["part"]),
        ("SHIFT = 2", "SHIFT = 2\n\ndef other():\n    return part", 10, ["part"]),
        ("(x: i32) -> i32:", "(x: i32, /) -> i32:", 10, ["part"]),
        ("row[0] = part(by)", "row[0] = part(by) + 1", 11, ["whole"]),
    ],
)
def test_what_reads_differently_is_read_anew(
    old: str, new: str, result: int, anew: list[str], read: list[str], tmp_path: Path
) -> None:
    """The text of a kernel, the constants in it and who else names it decide; the rest of its file does not."""
    assert result_of(TEXT, tmp_path) == 10
    del read[:]
    kernels = import_text(TEXT.replace(old, new), tmp_path, "same")
    assert read == anew
    row = np.zeros(1, np.uint8)
    kernels.whole(row, 40)
    assert int(row[0]) == result


def test_a_callee_of_another_type_is_not_what_was_known(tmp_path: Path) -> None:
    """The text of the caller is the same, and its call is wrong now."""
    import_text(TEXT, tmp_path, "same")
    with pytest.raises(KernelError, match="x must be an array"):
        import_text(TEXT.replace("(x: i32)", "(x: u8[:])").replace("x >> SHIFT", "x[0]"), tmp_path, "same")


def test_a_refused_kernel_is_refused_again(tmp_path: Path) -> None:
    """Only what is right is kept."""
    for _ in range(2):
        with pytest.raises(KernelError, match="cannot use `raise` statements"):
            import_text("@kernel\ndef f(x: i32):\n    raise x\n", tmp_path, "same")


def test_a_body_that_is_read_late_has_the_constants_of_its_definition(tmp_path: Path) -> None:
    """A name of the file may mean something else by then."""
    text = f"{TEXT}\nSHIFT = 5\n"
    assert [result_of(text, tmp_path) for _ in range(2)] == [10, 10]


def test_another_function_of_the_same_name_is_not_the_known_one(tmp_path: Path) -> None:
    """A function that calls itself `min` of Python is none that the language knows."""
    text = "@kernel\ndef f(x: i32) -> i32:\n    return min(x, 3)\n"
    import_text(text, tmp_path, "same")
    own = (
        "import builtins\nimport functools\n\n@functools.wraps(builtins.min)\ndef min(*x):\n    return 0\n\n"
    )
    with pytest.raises(KernelError, match="cannot call min"):
        import_text(own + text, tmp_path, "same")


def test_a_file_is_looked_through_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Where its definitions end is kept, too."""
    source_files._read.cache_clear()
    first = import_text(TEXT, tmp_path, "same").whole
    source_files._read.cache_clear()
    monkeypatch.setattr(source_files, "_walked", None)
    again = import_text(TEXT, tmp_path, "same").whole
    assert again.function.source == first.function.source
    assert again.code_bytes(VDSP_O2) == first.code_bytes(VDSP_O2)


def test_what_others_add_to_the_nodes_that_trees_share_is_no_part_of_a_file() -> None:
    """IPython's tracebacks give each node a parent, and every tree has the same `Load`: from there on the walk went round for ever."""
    shared = ast.parse("x", mode="eval").body.ctx  # type: ignore[attr-defined]
    shared.parent = ast.Name("stranger")
    try:
        assert source_files._walked("y = x")[0] == [source_files.Statement((), ["x", "y"])]
    finally:
        del shared.parent


def test_a_member_of_an_enumeration_that_changes_is_read_anew(read: list[str], tmp_path: Path) -> None:
    """What a kernel reads of an enumeration are its numbers."""
    text = "from enum import IntEnum\nclass Step(IntEnum):\n    SHIFT = 2\n" + TEXT.replace(
        "x >> SHIFT", "x >> Step.SHIFT"
    )
    assert result_of(text, tmp_path) == 10
    assert result_of(text.replace("    SHIFT = 2", "    SHIFT = 0x3"), tmp_path) == 5
    assert read == ["part", "whole", "part", "whole"]
