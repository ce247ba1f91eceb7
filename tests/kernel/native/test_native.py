"""Compiled Python: IR that comes with bfsim, for the present sources and for any processor."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.keep_native import ENTRIES, FOLDER
from bfsim.errors import BfsimError
from bfsim.files import store
from bfsim.kernel import native
from bfsim.kernel.native.sources import source_of
from tests.kernel.modules import import_text

PACKAGE = Path(native.__file__).parents[2]


def test_what_comes_with_bfsim_is_made_of_what_it_is_now() -> None:
    """After a change of a compiled function, or of a number in one, `python -m benchmarks.keep_native` makes it anew."""
    assert {each.name for each in FOLDER.iterdir()} == {each.digest() for each in ENTRIES}


def test_all_entries_come_with_bfsim() -> None:
    """A new one must be named to the script."""
    texts = (each.read_text() for each in PACKAGE.rglob("*.py"))
    assert sum(len(re.findall(r"^@native_entry\(", text, re.MULTILINE)) for text in texts) == len(ENTRIES)


@pytest.mark.parametrize("name", [each.symbol for each in ENTRIES])
def test_it_is_for_any_processor(name: str) -> None:
    """It names no machine, no address in a process and nothing of Python or numba, and calls only what LLVM has."""
    (entry,) = (each for each in ENTRIES if each.symbol == name)
    text = (store.shipped(native.__name__, entry.digest()) or b"").decode()
    assert re.findall(r"^define (?!internal ).*?@(\w+)", text, re.MULTILINE) == [name]
    assert not re.search(
        r"^target|inttoptr|target-cpu|target-features| x86| asm |Py[A-Z]|NRT_|numba_", text, re.MULTILINE
    )
    assert all(each.startswith("llvm.") for each in re.findall(r"^declare .*?@([\w.]+)", text, re.MULTILINE))


PARTS = '''
from bfsim.kernel.native.entries import native, native_entry
import numbers_of_it as n

STEP = 3
OTHER = 4

@native
def next_of(word: int) -> int:
    """Return the next one."""
    return word + STEP  # up

def other(word):
    return word - STEP

@native_entry("int64", "int64")
def follow(word: int) -> int:
    """Follow."""
    return next_of(word) * n.TIMES
'''
NUMBERS = "TIMES = 5\nSIZE = 6\n"


def source(folder: Path, parts: str, numbers: str) -> str:
    """Return what `follow` is made of, in modules of this text."""
    folder.mkdir()
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(sys.modules, "numbers_of_it", import_text(numbers, folder, "numbers_of_it"))
        return source_of(import_text(parts, folder, "parts_of_it").follow.python)


@pytest.mark.parametrize(
    ("before", "after", "is_other"),
    [
        ("word + STEP", "word - STEP", True),
        ("STEP = 3", "STEP = 4", True),
        ("TIMES = 5", "TIMES = 6", True),
        ("* n.TIMES", "+ n.TIMES", True),
        ("# up", "# and up", False),
        ("the next one", "what follows", False),
        ("OTHER = 4", "OTHER = 5", False),
        ("word - STEP", "word * STEP", False),
        ("SIZE = 6", "SIZE = 7", False),
        ("word: int) -> int", "word: object) -> object", False),
    ],
)
def test_it_is_made_anew_when_its_code_can_be_another(
    tmp_path: Path, before: str, after: str, is_other: bool
) -> None:
    """A change of a function that it calls, or of a number; no word, and nothing else in the same files."""
    assert before in PARTS + NUMBERS
    first, second = (
        source(tmp_path / name, *(text.replace(*change) if change else text for text in (PARTS, NUMBERS)))
        for name, change in (("first", None), ("second", (before, after)))
    )
    assert (first != second) == is_other


def test_who_needs_numba_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where sources were changed, and it is not installed."""
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.raises(
        BfsimError, match="numba must be installed where bfsim's own compiled functions are not"
    ):
        ENTRIES[0].ir()


IR = """
from bfsim.kernel.native.entries import native_entry, words_at

@native_entry("int64", "int64*", "int64")
def pick(words_from, number):
    return words_at(words_from)[number]

print("IndexError" in pick.ir(), len(pick.ir()) > 0)
"""


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", ["NUMBA_BOUNDSCHECK", "NUMBA_DISABLE_JIT"])
def test_what_is_compiled_is_the_same_in_any_environment(name: str) -> None:
    """What somebody has set to look for mistakes in code of their own ended bfsim, from the cache also without it."""
    done = subprocess.run(
        [sys.executable, "-c", IR],
        env=os.environ | {name: "1"},
        capture_output=True,
        check=True,
        text=True,
    )
    assert done.stdout == "False True\n"
