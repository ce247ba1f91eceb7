"""A core that runs ahead is one that does not: every record is the same, whatever its firmware does."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame, Kernel, Row
from bfsim.kernel import Work
from bfsim.machine.bus import tape
from bfsim.machine.bus.tape import Tape
from bfsim.machine.core.tasks.tasks import Tasks
from bfsim.machine.program import Main
from bfsim.trace import BoardRecord
from tests.machine.kernels import copy, first, negate, spin
from tests.machine.rig import SIZE, Play, every_frame, load, noise

DEEDS = ("rings", "own", "shared", "stage", "post", "handle", "interrupt")
Deeds = list[tuple[str, int]]


def through_rings(core: Core, frame: Frame, cycles: int) -> Play:
    """Invert some lines of a picture, on the way from one ring to another."""
    ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
    for _ in range(1 + cycles % frame.height):
        source, target = (yield from ring.line()), (yield from out.row())
        yield core.run(negate, source, target)
        yield core.run(spin, cycles)
        out.send()
    yield from out.flush()


def kernels(core: Core, cycles: int, image: str) -> Play:
    """Read a picture where it lies, outside of L1."""
    core.publish(found=(yield core.run(first, core.rows(image)[cycles % SIZE.height_px])))
    yield core.run(copy, core.rows(image)[cycles % SIZE.height_px], core.array("single_row"))


def staged(core: Core, cycles: int) -> Play:
    """Work in a stage of its own."""
    with core.stage("Work"):
        yield core.run(spin, cycles)


def handled(core: Core) -> Play:
    """From now on every call may be interrupted."""
    core.on_interrupt("SUPPLEMENTAL_0", lambda core: core.remark("was interrupted"))
    core.request_interrupt("SUPPLEMENTAL_0")
    yield from ()


def doing(deeds: Deeds) -> Main:
    """Return what a core does with a frame: `deeds`, each with a number of cycles."""

    def work(core: Core, frame: Frame) -> Play:
        for deed, cycles in deeds:
            yield from {
                "rings": lambda cycles: through_rings(core, frame, cycles),
                "own": lambda cycles: kernels(core, cycles, "image"),
                "shared": lambda cycles: kernels(core, cycles, "shared_image"),
                "stage": lambda cycles: staged(core, cycles),
                "post": lambda _: core.post("a turn"),
                "handle": lambda _: handled(core),
                "interrupt": lambda _: core.interrupt_core("B" if core.name == "A" else "A"),
            }[deed](cycles)

    return every_frame(work)


def outcome(deeds: tuple[Deeds, Deeds], *, ahead: bool = True) -> BoardRecord:
    """Run a firmware of two cores, ahead where they may or in step with the simulated time."""
    board = load(*map(doing, deeds))
    board.ahead = board.ahead if ahead else None
    return replace(board.run(noise(2)), events=0)


deeds = st.lists(st.tuples(st.sampled_from(DEEDS), st.integers(1, 400)), max_size=9)


@settings(max_examples=25, deadline=None)
@given(st.tuples(deeds, deeds))
@example(([("rings", 1), ("handle", 1)], [("interrupt", 1)])).via("asked for before there was a handler")
@example(([], [("rings", 1), ("handle", 1)])).via("a frame that ends behind what was done ahead")
@example(([], [("rings", 1), ("handle", 1), ("rings", 1)])).via("a ring meets it when nothing is late")
def test_what_is_done_ahead_is_charged_as_if_it_were_not(deeds: tuple[Deeds, Deeds]) -> None:
    """Rings, own and shared memory, stages, semaphores, and handlers that come in between."""
    assert outcome(deeds) == outcome(deeds, ahead=False)


def test_a_stage_whose_calls_have_accessed_l1_once_may_access_it_more() -> None:
    """A single column that calls accessed had the next ones laid by rows: a clock was off by 2 ** 63 cycles."""
    record = outcome(([("stage", 1), ("own", 1), ("stage", 1), ("shared", 1)], []))
    stalls = [
        cclk
        for frame in record.frames
        for core in frame.cores
        for each in core.stages
        for cclk in each.stall_cclk.values()
    ]
    assert min(stalls) > 0
    assert max(stalls) < record.frames[-1].result_cclk


def test_python_makes_each_call_once_and_machine_code_those_that_come_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of kernels in L1 and on memory of the core's own, with or without a value; in step Python makes them all."""
    asked: list[str] = []
    run = Tasks._run  # what makes a call that machine code does not know

    def seen(tasks: Tasks, kernel: Kernel, *arguments: Row | int) -> Work:
        asked.append(kernel.name)
        return run(tasks, kernel, *arguments)

    monkeypatch.setattr(Tasks, "_run", seen)
    deeds: tuple[Deeds, Deeds] = (20 * [("rings", 5), ("own", 1)], [])
    whole = outcome(deeds)
    made = {name: asked.count(name) for name in asked}
    assert made["spin"] == made["first"] == made["copy"] == 1
    asked.clear()
    assert outcome(deeds, ahead=False) == whole
    assert min(asked.count(name) for name in made) >= 2 * 20


@pytest.mark.parametrize("goes_on", [False, True])
def test_machine_code_makes_calls_once_the_frame_is_over_in_which_others_are_told_of_them(
    monkeypatch: pytest.MonkeyPatch, goes_on: bool
) -> None:
    """Python made them until the end, which took twice the time; the records are the same, and who is told of all calls is."""
    asked, told, told_of_all = Counter[str](), Counter[str](), Counter[str]()
    run = Tasks._run

    def seen(tasks: Tasks, kernel: Kernel, *arguments: Row | int) -> Work:
        asked[kernel.name] += 1
        return run(tasks, kernel, *arguments)

    deeds: tuple[Deeds, Deeds] = (5 * [("rings", 5), ("own", 1)], [("rings", 1)])
    plain = replace(load(*map(doing, deeds)).run(noise(9)), events=0)
    monkeypatch.setattr(Tasks, "_run", seen)
    board = load(*map(doing, deeds))
    board.in_first_frame = (lambda kernel, _: told.update([kernel.name]),)
    board.before_call = (lambda kernel, _: told_of_all.update([kernel.name]),) if goes_on else ()
    assert replace(board.run(noise(9)), events=0) == plain
    assert told_of_all == ({name: 9 * count for name, count in told.items()} if goes_on else {})
    assert asked.total() == told_of_all.total() if goes_on else asked.total() < 2 * told.total()


def test_calls_that_meet_nobody_end_a_stretch_before_its_room_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each in a stage of its own, and no wait between: more than there was room for wrote over the other core's, and the run never ended."""
    lengths: list[int] = []
    clear = Tape.clear

    def seen(of: Tape) -> None:
        lengths.append(of.noted)
        clear(of)

    monkeypatch.setattr(Tape, "clear", seen)
    deeds: tuple[Deeds, Deeds] = ([("rings", 1), *(60 * [("stage", 5)])], [("rings", 2)])
    in_step, whole = outcome(deeds, ahead=False), outcome(deeds)
    assert max(lengths) > 60
    lengths.clear()
    monkeypatch.setattr(tape, "MOST_OPERATIONS", 20)
    assert outcome(deeds) == whole == in_step
    assert 20 < max(lengths) < 30


def test_rings_whose_ends_are_the_same_have_lines_of_their_own() -> None:
    """They are found by their first and last rows, and are two."""
    seen: list[list[int]] = []

    def work(core: Core, _: Frame) -> Play:
        rows = core.rows("image")
        for row, value in zip(rows, range(4), strict=False):
            row.array[0] = value
        for second in (1, 2, 1):
            ring, found = core.input_ring([rows[0], rows[second], rows[3]], "in_ring"), []
            for _line in range(3):
                found.append((yield core.run(first, (yield from ring.line()))))
            seen.append(found)

    load(every_frame(work)).run(noise(3))
    assert seen == 3 * [[0, 1, 3], [0, 2, 3], [0, 1, 3]]
