"""What code of a file keeps from call to call: each core's own, and as the file has it when a run begins."""

from __future__ import annotations

from typing import Any

from bfsim.api import Core, Frame, i32, kernel_from
from tests.machine.rig import Play, every_frame, run
from tests.sums import DATA

FILE = DATA / "keeping.o"
begin = kernel_from(FILE, "begin", value=i32)
add = kernel_from(FILE, "add", value=i32, result=i32)
"""Adds to a variable, which is 100 at first, and returns it."""


def adding(value: int, sums: list[int]) -> Any:
    """Make a main loop that adds to it once in each frame, and in each of two stages, for each has calls of its own."""

    def body(core: Core, _frame: Frame) -> Play:
        with core.stage("Work"):
            sums.append((yield core.run(add, value)))
        with core.stage("More work"):
            sums.append((yield core.run(add, value)))

    return every_frame(body)


def test_each_core_has_its_own_and_each_run_begins_anew() -> None:
    add(50)  # outside of a run
    for _ in range(2):
        of_a: list[int] = []
        of_b: list[int] = []
        run(adding(1, of_a), adding(10, of_b), frames=2)
        assert of_a == [101, 102, 103, 104]
        assert of_b == [110, 120, 130, 140]


def test_functions_of_a_file_share_them() -> None:
    sums: list[int] = []

    def body(core: Core, _frame: Frame) -> Play:
        yield core.run(begin, 7)
        sums.append((yield core.run(add, 1)))

    run(every_frame(body))
    assert sums == [8]
