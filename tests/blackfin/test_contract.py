"""Code that is called as one function: what LLVM may take for granted of it changes no register that is read, no count and no cycle."""

from __future__ import annotations

import pytest

from bfsim.blackfin.execution.processor import OUTSIDE, Processor
from bfsim.blackfin.execution.subroutines import CHECKED, TRUSTED
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.timing.tables import ADI, GNU, Timing
from tests.blackfin.code import CODE, ISQRT, processor
from tests.blackfin.test_divisions import PAIRS, UDIVSI3

AROUND = 0xC
"""Where f of SKIPS returns to, from CODE on."""
SKIPS = "6701 00e30800 0864 00e30900 1064 2701 1000 0f31 3164 3938 1000 1000"
"""main calls f, adds 1, calls g, adds 2; f returns behind the call of g."""
OTHERS = "0730 cc30 0850 1000"
"""R0 = R7 + L0."""


def called(code: str, *, is_trusted: bool, timing: Timing = GNU) -> Processor:
    """Return a core with code that is called as a function."""
    core = processor(code, timing, fuel=None)
    core.entries, core.contract = {CODE}, TRUSTED if is_trusted else CHECKED
    return core


@pytest.mark.parametrize("timing", [GNU, ADI], ids=lambda each: each.name)
@pytest.mark.parametrize("is_trusted", [True, False])
@pytest.mark.parametrize("code", [UDIVSI3, ISQRT], ids=["division", "root"])
def test_it_returns_and_costs_what_any_code_does(code: str, is_trusted: bool, timing: Timing) -> None:
    core, other = called(code, is_trusted=is_trusted, timing=timing), processor(code, timing, fuel=None)
    for first, second in PAIRS[:300]:
        for each in (core, other):
            each.state["R0"], each.state["R1"] = first, second
            assert each.call(CODE) is Event.UNKNOWN_TARGET
            assert each.state["PC"] == OUTSIDE
        for register in ("R0", "CLOCK", "WAITED"):
            assert core.state[register] == other.state[register], (register, first, second)
        assert core.prepared().counts.tolist() == other.prepared().counts.tolist()


def test_a_function_that_is_trusted_returns_to_where_it_was_called_or_is_left() -> None:
    """So a loop has no way in that nobody goes, and LLVM sees it as a loop. Other code may return to wherever some call comes back."""
    trusted, checked = (called(SKIPS, is_trusted=each) for each in (True, False))
    for core in (trusted, checked):
        assert core.call(CODE) is Event.UNKNOWN_TARGET
    assert trusted.state["PC"] == CODE + AROUND
    assert (checked.state["PC"], checked.state["R0"]) == (OUTSIDE, 2)


def test_registers_that_no_caller_sets_are_0() -> None:
    """The lengths of circular buffers among them: a loop that moves an index register need not ask whether it is at an end."""
    core, any_code = called(OTHERS, is_trusted=True), processor(OTHERS)
    for each in (core, any_code):
        each.state["R7"], each.state["L0"] = 3, 4
        each.call(CODE)
    assert (core.state["R0"], any_code.state["R0"]) == (0, 7)
