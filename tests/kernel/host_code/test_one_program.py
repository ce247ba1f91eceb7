"""What is costed is what is executed and traced: accesses that compilers move are reported where they are costed."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2, CompilerProfile, Kernel
from bfsim.kernel.calls import access_log as log
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.costs.counters import Counter
from tests.kernel.modules import import_text, kernel_of
from tests.kernel.plain import arrays_of
from tests.kernel.programs import programs
from tests.kernel.running import CALLING_VDSP
from tests.tiers import tried

ROOM = 1 << 16
HANDED_ON = {"row": "a"}  # by the random programs, to `mix`
DTYPES = {"u8": np.uint8, "i16": np.int16, "u16": np.uint16, "i32": np.int32, "f32": np.float32}
KINDS = {log.LOAD: "load", log.STORE: "store"}
Accesses = dict[tuple[str, str], int]
OPTIMISING = pytest.mark.parametrize("profile", [GCC_O2, VDSP_O2], ids=lambda each: each.name)


@dataclass
class Run:
    """A kernel that has run once on arrays that all lie in traced memory. Accesses are by array and kind."""

    kernel: Kernel
    profile: CompilerProfile
    arrays: dict[str, NDArray[Any]]
    scalars: tuple[Any, ...] = ()
    costed: Accesses = field(default_factory=dict)
    traced: Accesses = field(default_factory=dict)

    def __post_init__(self) -> None:
        placed, first = self._placed()
        trace = AccessTrace(
            placed["arena"], len(placed["arena"]), np.zeros(log.LOG + log.ENTRY_WORDS * ROOM, np.int64)
        )
        code = self.kernel.compile(self.profile, traced=True)
        rows = [placed[each] for each in self.arrays]
        totals = code.new_totals()
        work = self.kernel.prepare(code, rows, totals, trace).run(*rows, *self.scalars)
        found: Tally[tuple[str, str]] = Tally()
        for entry in trace.entries(work.accesses).tolist():
            at, kind = entry & log.OFFSET_MASK, entry >> log.KIND_BIT & log.KIND_MASK
            found[max((each for each in first if first[each] <= at), key=first.__getitem__), KINDS[kind]] += 1
        self.traced = dict(found)
        self.costed = _costed(code.counters, totals.tolist())
        self.arrays = {name: placed[name] for name in self.arrays}

    def _placed(self) -> tuple[dict[str, NDArray[Any]], dict[str, int]]:
        """Copies of the arrays side by side in one arena, and the offset of each."""
        first, offset = {}, 0
        for name, array in self.arrays.items():
            first[name] = offset
            offset += -(-array.nbytes // 64) * 64
        arena = np.zeros(offset, np.uint8)
        placed: dict[str, NDArray[Any]] = {"arena": arena}
        for name, array in self.arrays.items():
            placed[name] = arena[first[name] : first[name] + array.nbytes].view(array.dtype)
            placed[name][:] = array
        return placed, first


def _costed(counters: Sequence[Counter], totals: Sequence[int]) -> Accesses:
    """How often the costed code loads from and stores to each array; one that is handed to `mix` keeps its name."""
    found: Tally[tuple[str, str]] = Tally()
    for counter, events in zip(counters, totals, strict=False):
        for name, reads, writes in counter.array_accesses:
            array = HANDED_ON.get(name, name)
            found[array, "load"] += events * reads
            found[array, "store"] += events * writes
    return {each: count for each, count in found.items() if count}


TABLE = """
@kernel
def f(out: i32[:], table: {kind}[:], n: i32):
    for i in range(n):
        out[i & 15] = table[3] + i
"""


@OPTIMISING
@pytest.mark.parametrize(("kind", "loads"), [("u16", 1), ("i16", 1), ("i32", 1000), ("u8", 1000)])
def test_a_load_that_leaves_its_loop_is_made_once(
    profile: CompilerProfile, kind: str, loads: int, tmp_path: Path
) -> None:
    """A store of another width cannot change it; a store of the same width, or one beside bytes, may: as in C."""
    kernel = import_text(TABLE.format(kind=kind), tmp_path).f
    arrays = {"out": np.zeros(16, np.int32), "table": np.arange(8).astype(DTYPES[kind])}
    run = Run(kernel, profile, arrays, (1000,))
    assert run.traced == {("table", "load"): loads, ("out", "store"): 1000}


def test_arrays_of_different_widths_must_not_share_what_is_written(tmp_path: Path) -> None:
    """The load before the loop would miss the store: C leaves that undefined, here it is refused; bytes may share."""
    words = np.zeros(16, np.int32)
    kernel = import_text(TABLE.format(kind="u16"), tmp_path).f
    with pytest.raises(KernelError, match=r"out \(int32\) and table \(uint16\) must not share memory"):
        kernel(words, words.view(np.uint16)[:8], 4)
    kernel(words[:8], words[8:].view(np.uint16), 4)
    import_text(TABLE.format(kind="u8"), tmp_path).f(words, words.view(np.uint8), 4)


@OPTIMISING
def test_a_loop_that_is_not_entered_loads_nothing(profile: CompilerProfile, tmp_path: Path) -> None:
    """The load before a loop is made only if the loop is entered: the array may have no such element."""
    kernel = import_text(TABLE.format(kind="u16"), tmp_path).f
    assert not Run(
        kernel, profile, {"out": np.zeros(16, np.int32), "table": np.zeros(1, np.uint16)}, (0,)
    ).traced


@OPTIMISING
def test_a_load_that_a_way_out_may_skip_stays(profile: CompilerProfile, tmp_path: Path) -> None:
    """What comes after a `break` is not made in every run of the loop, so it cannot be made before it."""
    text = """
    @kernel
    def f(out: i32[:], row: u8[:], table: u16[:], n: i32):
        for i in range(n):
            if row[i] == 9:
                break
            out[i] = table[3]
    """
    arrays = {"out": np.zeros(8, np.int32), "row": np.full(8, 9, np.uint8), "table": np.zeros(4, np.uint16)}
    assert Run(import_text(text, tmp_path).f, profile, arrays, (8,)).traced == {("row", "load"): 1}


@OPTIMISING
def test_the_value_that_goes_along_with_an_index_is_loaded_once(
    profile: CompilerProfile, tmp_path: Path
) -> None:
    """`a[least]` is loaded before the loop; in it, only `a[j]` is, and the least comes out of it in a register, as in GCC's code."""
    text = """
    @kernel
    def f(a: {kind}[:]) -> i32:
        least = 0
        for j in range(1, len(a)):
            if a[j] < a[least]:
                least = j
        if i32(a[least]) > 9:
            least = -1
        return least
    """
    for kind in ("u16", "i32", "f32"):
        kernel = import_text(text.format(kind=kind), tmp_path).f
        values = np.array([5, 4, 7, 2, 9, 2, 8], DTYPES[kind])
        run = Run(kernel, profile, {"a": values})
        assert run.traced == {("a", "load"): 7}
        assert kernel(values) == 3
        assert kernel(values[:1]) == 0


@OPTIMISING
def test_what_only_one_side_needs_is_loaded_there(profile: CompilerProfile, tmp_path: Path) -> None:
    """A value that is read before a test and used on its rarer side is loaded on that side [tree-ssa-sink.cc]."""
    text = """
    @kernel
    def f(row: u16[:], table: u16[:], out: i32[:]):
        for i in range(len(row)):
            value = table[i]
            if row[i] == 7:
                out[i] = value
    """
    arrays = {"row": np.arange(16, dtype=np.uint16), "table": np.arange(16, dtype=np.uint16)}
    run = Run(import_text(text, tmp_path).f, profile, arrays | {"out": np.zeros(16, np.int32)})
    assert run.traced == {("row", "load"): 16, ("table", "load"): 1, ("out", "store"): 1}


@tried(3, 15)
def test_a_random_program_makes_the_accesses_that_it_is_costed_with(examples: int, tmp_path: Path) -> None:
    """Array by array, loads and stores, in every profile; whatever the compiler moves, leaves out or repeats."""

    @settings(
        max_examples=examples, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
    )
    @given(text=programs(), x=st.sampled_from([0, 3, 900, -7]), y=st.integers(0, 70))
    def holds(text: str, x: int, y: int) -> None:
        program = import_text(text, tmp_path).program
        for profile in (GCC_O0, GCC_O2, CALLING_VDSP):
            run = Run(program, profile, arrays_of(0), (x, y))
            assert run.traced == run.costed

    holds()


O0_TEXTS = {
    "a bound is read in each test": (
        "def f(a: i32[:], row: i32[:]):\n    for i in range(a[0]):\n        row[i] = i\n",
        {("a", "load"): 5, ("row", "store"): 4},
    ),
    "a minimum reads each value once": (
        "def f(a: i32[:], row: i32[:]):\n    row[0] = a[1] if a[1] < a[2] else a[2]\n",
        {("a", "load"): 2, ("row", "store"): 1},
    ),
    "a rotation reads its value once": (
        "def f(a: i32[:], row: i32[:]):\n    row[0] = i32((u32(a[1]) << 3) | (u32(a[1]) >> 29))\n",
        {("a", "load"): 1, ("row", "store"): 1},
    ),
}


@pytest.mark.parametrize("name", O0_TEXTS)
def test_code_that_nobody_optimised_reads_what_gcc_reads(name: str, tmp_path: Path) -> None:
    """GCC's front end folds and repeats, and so does what is traced."""
    text, accesses = O0_TEXTS[name]
    kernel = kernel_of(text, tmp_path)
    values = {"a": np.array([4, 7, 9, 1], np.int32), "row": np.zeros(4, np.int32)}
    assert Run(kernel, GCC_O0, values).traced == accesses


@pytest.mark.parametrize(("kind", "words"), [("u8", 8), ("u16", 16), ("i32", 32)])
def test_a_library_routine_that_fills_stores_words(kind: str, words: int, tmp_path: Path) -> None:
    """A loop that fills is a call of memset with GCC, which stores a word at a time, and a loop with ADI's compiler."""
    text = f"@kernel\ndef f(a: {kind}[:], n: i32):\n    for i in range(n):\n        a[i] = 0\n"
    kernel = import_text(text, tmp_path).f
    arrays = {"a": np.ones(32, DTYPES[kind])}
    assert Run(kernel, GCC_O2, arrays, (32,)).traced == {("a", "store"): words}
    assert Run(kernel, VDSP_O2, arrays, (32,)).traced == {("a", "store"): 32}
