"""Timelines of boards in tests: the spans of a run, and their sums beside the accounts of the cores."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from bfsim.machine.board import Board
from bfsim.spans import Span, SpanKind
from bfsim.trace import BoardRecord, CoreFrame, FrameRecord, StageCost
from tests.machine.rig import noise


def told(board: Board, frames: int = 2) -> tuple[BoardRecord, list[Span]]:
    """Run a board on pictures of noise; return its records and its timeline."""
    spans: list[Span] = []
    return board.run(iter(noise(frames, board.size)), on_spans=spans.extend), spans


def by_track(spans: Iterable[Span]) -> dict[tuple[str, str], list[Span]]:
    """Return the spans of each track, in the order in which they were told."""
    tracks: dict[tuple[str, str], list[Span]] = defaultdict(list)
    for each in spans:
        tracks[each.track].append(each)
    return tracks


def assert_orderly(spans: Iterable[Span]) -> None:
    """Spans have whole cycles; those of a track come in the order of time, and none begins before the last one ended."""
    for track in by_track(spans).values():
        assert all(type(each.begin_cclk) is int and each.begin_cclk <= each.end_cclk for each in track), track
        assert all(before.end_cclk <= after.begin_cclk for before, after in pairwise(track)), track


def assert_tiled(frames: Sequence[FrameRecord], spans: Sequence[Span]) -> None:
    """Calls, other work and waits fill each frame of each core without a gap, and add up to its budget; so do the stages."""
    tracks = by_track(spans)
    for frame in frames:
        for core in frame.cores:
            where = f"core {core.core}"
            stages, work = (_within(core, tracks[where, name]) for name in ("stages", "work"))
            assert [each.elapsed_cclk for each in _within(core, tracks[where, "frames"])] == [
                core.end_cclk - core.begin_cclk
            ]
            for tiles in (stages, work):
                edges = [(each.begin_cclk, each.end_cclk) for each in tiles]
                assert all(before[1] == after[0] for before, after in pairwise(edges))
                assert (edges[0][0], edges[-1][1]) == (core.begin_cclk, core.end_cclk)
            assert _elapsed(stages) == {
                each.stage: each.elapsed_cclk for each in core.stages if each.elapsed_cclk
            }
            assert sorted(_costs(work), key=_name) == sorted(_with_cycles(core), key=_name)


def _within(core: CoreFrame, spans: Sequence[Span]) -> list[Span]:
    return [each for each in spans if core.begin_cclk <= each.begin_cclk and each.end_cclk <= core.end_cclk]


def _name(cost: StageCost) -> str:
    return cost.stage


def _with_cycles(core: CoreFrame) -> list[StageCost]:
    return [each for each in core.stages if each.elapsed_cclk]


def _elapsed(spans: Sequence[Span]) -> dict[str, int]:
    sums: Counter[str] = Counter()
    for each in spans:
        sums[each.stage] += each.elapsed_cclk
    return dict(sums)


def _costs(spans: Sequence[Span]) -> Iterator[StageCost]:
    """Add up what the spans of each stage cost."""
    for stage in {each.stage for each in spans if each.elapsed_cclk}:
        mine = [each for each in spans if each.stage == stage]
        stalls: Counter[object] = Counter()
        for each in mine:
            stalls.update(each.stall_cclk)
        issue_cclk = sum(each.issue_cclk for each in mine)
        idle_cclk = sum(each.elapsed_cclk for each in mine) - issue_cclk - sum(stalls.values())
        yield StageCost(stage=stage, issue_cclk=issue_cclk, stall_cclk=dict(stalls), idle_cclk=idle_cclk)  # type: ignore[arg-type]


def assert_flows(spans: Sequence[Span]) -> None:
    """A transfer with a flow ended a wait of one core, or of both; every wait with one was ended by one transfer."""
    transfers = [each for each in spans if each.kind is SpanKind.TRANSFER and each.flow]
    waits = [each for each in spans if each.kind in {SpanKind.STALL, SpanKind.IDLE} and each.flow]
    assert len(transfers) + len(waits) == sum(each.flow > 0 for each in spans)
    by_flow = {each.flow: each for each in transfers}
    assert len(by_flow) == len(transfers)
    assert {each.flow for each in waits} == set(by_flow)
    assert len({(each.flow, each.where) for each in waits}) == len(waits)
    assert all(by_flow[each.flow].end_cclk <= each.end_cclk for each in waits)
