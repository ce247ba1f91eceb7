"""The timeline: what cores and devices tell of themselves, to the cycle, and that telling changes nothing."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.spans import Span, SpanKind
from bfsim.trace import StallReason
from tests.machine.kernels import spin, total
from tests.machine.made_boards import CHIP, in_work, made_board
from tests.machine.rig import Play, cycles_of, every_frame, noise, see_all
from tests.machine.steps import LDFS, STEPS, Step, handler, main_of
from tests.machine.timelines import assert_flows, assert_orderly, assert_tiled, told


@given(STEPS, STEPS, st.booleans(), st.booleans(), st.sampled_from(list(LDFS)))
@settings(max_examples=25, deadline=None)
def test_spans_of_chance_firmware_add_up(
    steps_a: list[Step], steps_b: list[Step], a_handles: bool, b_handles: bool, ldf: str
) -> None:
    """Whatever the cores do, and in whichever order they meet."""
    mains = main_of(steps_a, handles=a_handles), main_of(steps_b, handles=b_handles)
    outcome, spans = told(made_board(*mains, ldf=LDFS[ldf]))
    assert_orderly(spans)
    assert_tiled(outcome.frames, spans)
    assert_flows(spans)


def of_kind(spans: Sequence[Span], kind: SpanKind, where: str = "core A") -> list[Span]:
    """Return the spans of one kind at one place."""
    return [each for each in spans if (each.kind, each.where) == (kind, where)]


def test_a_call_begins_where_the_last_one_ended_and_lasts_what_it_costs() -> None:
    """Two calls in a stage: name, stage, issue cycles, and nothing between them."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 100)
        yield core.run(spin, 7)

    _, spans = told(made_board(in_work(work)), frames=1)
    first, second = of_kind(spans, SpanKind.CALL)
    assert (first.name, first.stage, first.issue_cclk) == ("spin", "Work", cycles_of(spin, 100))
    assert first.elapsed_cclk == first.issue_cclk + sum(first.stall_cclk.values())
    assert second.begin_cclk == first.end_cclk


def test_a_call_holds_the_stalls_of_its_accesses() -> None:
    """A call that reads SDRAM is one span, its stalls by reason inside."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(total, core.array("in_sdram"))

    outcome, spans = told(made_board(in_work(work)), frames=1)
    (call,) = of_kind(spans, SpanKind.CALL)
    (cost,) = [each for each in outcome.frames[0].cores[0].stages if each.stage == "Work"]
    assert (call.issue_cclk, call.stall_cclk) == (cost.issue_cclk, cost.stall_cclk)
    assert StallReason.SDRAM_PAGE_HIT in call.stall_cclk


def test_a_wait_that_is_interrupted_has_a_span_before_and_one_behind() -> None:
    """A waits for B, who interrupts it on the way: wait, handler, wait."""

    def wait(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", handler)
        yield from core.wait("B")

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        yield from core.interrupt_core("A")
        yield core.run(spin, 1000)
        yield from core.post("B")

    _, spans = told(made_board(every_frame(wait), every_frame(interrupt)), frames=1)
    waits = [each for each in of_kind(spans, SpanKind.STALL) if StallReason.SEMAPHORE in each.stall_cclk]
    (taken,) = of_kind(spans, SpanKind.INTERRUPT)
    assert taken.name == "SUPPLEMENTAL_0"
    assert [each.end_cclk for each in waits[:1]] == [taken.begin_cclk]
    assert [each.begin_cclk for each in waits[1:]] == [taken.end_cclk]
    assert taken.elapsed_cclk > CHIP.events.interrupt_entry_cclk + CHIP.events.interrupt_exit_cclk


def test_spans_are_told_while_the_run_goes_on() -> None:
    """A timeline is handed out in parts, and nobody keeps it."""

    def work(core: Core, frame: Frame) -> Play:
        for _ in range(100):
            yield core.run(spin, 1)
            yield from core.post("token")

    parts: list[int] = []
    board = made_board(every_frame(work), see_all)
    board.run(noise(20, board.size), on_spans=lambda spans: parts.append(len(spans)))
    assert len(parts) > 10
    assert max(parts) < 1000
