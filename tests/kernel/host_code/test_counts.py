"""What is counted is what ran: line by line as often as plain Python runs it."""

from __future__ import annotations

import ast
import sys
from collections import Counter as Tally
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from bfsim.kernel import GCC_O0, Kernel
from bfsim.kernel.host_code import instrument
from tests.kernel.modules import import_text
from tests.kernel.plain import arrays_of
from tests.kernel.programs import ARGUMENTS, programs
from tests.kernel.running import CALLING_VDSP
from tests.kernel.words import NAMES, Row, Word
from tests.tiers import tried

OFFSET = 1  # of the line that makes annotations strings


def plain_lines(text: str, arrays: dict[str, Any], x: int, y: int) -> Tally[int]:
    """Run `program` in plain Python and count how often each of its lines begins."""
    names = dict(NAMES)
    exec(compile("from __future__ import annotations\n" + text, "<plain>", "exec"), names)
    found: Tally[int] = Tally()

    def trace(frame: FrameType, event: str, _argument: object) -> Any:
        if frame.f_code.co_filename != "<plain>" or frame.f_code.co_name != "program":
            return None
        if event == "line":
            found[frame.f_lineno - OFFSET] += 1
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        names["program"](
            *(Row(each) for each in arrays.values()), Word(x, signed=True), Word(y, signed=False)
        )
    finally:
        sys.settrace(before)
    return found


def counted_lines(program: Kernel, arrays: dict[str, Any], x: int, y: int) -> dict[int, int]:
    """Run the kernel in gcc-O0, where no block is merged with another, and count its lines from its decorator."""
    code = program.compile(GCC_O0)
    totals = code.new_totals()
    program.prepare(code, list(arrays.values()), totals).run(*arrays.values(), x, y)
    found: dict[int, int] = {}
    for counter, events in zip(code.counters, totals.tolist(), strict=False):
        if counter.value is None and counter.routine == program.function.symbol:
            for place, _, _ in counter.line_cclk:
                found[place.line] = max(found.get(place.line, 0), events)
    return found


def simple_statements(text: str) -> tuple[int, list[int]]:
    """Line of the decorator of `program`, and the lines of its statements without a body."""
    definition = next(
        each for each in ast.parse(text).body if isinstance(each, ast.FunctionDef) and each.name == "program"
    )
    simple = (ast.Assign, ast.AugAssign, ast.AnnAssign, ast.Expr, ast.Return)
    lines = [each.lineno for each in ast.walk(definition) if isinstance(each, simple)]
    return definition.decorator_list[0].lineno, lines


@tried(6, 40)
def test_every_statement_of_a_random_program_is_counted_as_often_as_it_ran(
    examples: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """The blocks that are costed are the statements that ran: the counts are those of a traced run by Python."""

    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    @given(text=programs(), **ARGUMENTS)
    def holds(text: str, seed: int, x: int, y: int) -> None:
        program: Kernel = import_text(text, tmp_path_factory.mktemp("program")).program
        first, statements = simple_statements(text)
        expected = plain_lines(text, arrays_of(seed), x, y)
        found = counted_lines(program, arrays_of(seed), x, y)
        assert statements
        for line in statements:
            assert found.get(line - first + 1, 0) == expected[line], text.splitlines()[line - 1]

    holds()


def test_a_traced_run_sees_both_sides_of_a_test() -> None:
    """The ruler itself: plain Python's own count of a loop with a test in it."""
    text = "\n@kernel\ndef program(a: u8[:], x: i32, y: u32) -> i32:\n    p = i32(0)\n    for i in range(5):\n        if i < 2:\n            p = p + i\n    return p\n"
    found = plain_lines(text, {"a": np.zeros(16, np.uint8)}, 1, 2)
    assert (found[4], found[6], found[7], found[8]) == (1, 5, 2, 1)


CALLER = """
@kernel
def digits(x: i32) -> i32:
    found = 0
    while x > 0:
        if x % 10 > 4:
            found += 1
        x = x // 10
    return found

@kernel
def f(a: u8[:], b: u8[:]):
    for i in range(len(a)):
        if a[i] > 20:
            b[i] = digits(a[i]) + digits(b[i])
"""


def test_a_routine_counts_alike_whether_inlined_or_called(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the host's compiler does with a routine is not seen in its counts."""
    a = np.arange(64, dtype=np.uint8)
    counts = []
    for name in ("inlined", "called"):
        kernel = import_text(CALLER, tmp_path, name).f
        code, arrays = kernel.compile(CALLING_VDSP), [a, a[::-1].copy()]
        totals = code.new_totals()
        cclk = kernel.prepare(code, arrays, totals).run(*arrays).issue_cclk
        counts.append((cclk, totals.tolist(), arrays[1].tolist()))
        monkeypatch.setattr(instrument, "LARGE_PROGRAM_COUNTERS", 0)
        monkeypatch.setattr(instrument, "LARGE_ROUTINE_COUNTERS", 0)
    assert counts[0] == counts[1]
