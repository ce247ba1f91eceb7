"""One side of a comparison, from a run or from a result that was read back."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import fields

from bfsim.report.budget.times import frame_rate_hz
from bfsim.report.diff.library import with_callers
from bfsim.report.diff.side import FRAMES, SEPARATOR, Line, Owner, Side, Source, Stall
from bfsim.report.profile.lines import LineProfile, lines_of, place_of
from bfsim.report.results.result import Result
from bfsim.report.results.seen_json import name_of_object
from bfsim.trace import FrameRecord, Identity, KernelRecord, RunRecord

CostedLine = tuple[str, str, int]
"""Stage, symbol and line."""


def result_side(result: Result, chosen: Collection[int]) -> Side:
    """Return a run as a side, with the frames whose indices are chosen; lines are counted over a whole run only."""
    run = result.run
    frames = [each for each in run.frames if each.index in chosen]
    places = [place for place, each in enumerate(run.frames) if each.index in chosen]
    owners, waits = Counter[Owner](), Counter[str]()
    for each in result.owners:
        waiting = sum(each.waiting_cclk[place] for place in places)
        elapsed = sum(each.elapsed_cclk[place] for place in places)
        owners[Owner(each.stage, each.owner, each.symbol)] += elapsed - waiting
        waits[each.stage] += waiting
    owned, sources = with_callers(owners, _sources(run))
    names = dict.fromkeys(name for frame in frames for name in frame.results)
    return Side(
        configuration=identity_words(run.identity) | {FRAMES: str(len(run.frames))},
        cclk_hz=run.identity.cclk_hz,
        frame_ms=1000 / frame_rate_hz(run.frames, run.identity.cclk_hz),
        frames=tuple(each.index for each in frames),
        owners=owned,
        waits=waits,
        sources=sources if len(frames) == len(run.frames) else {},
        memories={each.buffer: each.memory for each in run.buffers},
        frame_cclk={each.index: _longest_cclk(each) for each in frames},
        results={name: [frame.results.get(name) for frame in frames] for name in names},
        seen={
            index: Counter(map(name_of_object, result.seen[index]["objects"]))
            for index in sorted(set(result.seen) & {each.index for each in frames})
        },
    )


def identity_words(identity: Identity) -> dict[str, str]:
    """Return what a result depends on, by names for people."""
    return {
        field.name.replace("_digest", ": content").replace("_", " "): _in_words(getattr(identity, field.name))
        for field in fields(Identity)
    }


def _in_words(value: str | float | tuple[str, ...]) -> str:
    """Return a value of an identity: a rate in Hz to a millionth, such as 600,000,000 or 133,333,333.333333."""
    if isinstance(value, float):
        return f"{value:,.6f}".rstrip("0").removesuffix(".")
    return SEPARATOR.join(value) if isinstance(value, tuple) else str(value)


def _longest_cclk(frame: FrameRecord) -> int:
    return max(core.end_cclk - core.begin_cclk for core in frame.cores)


def _sources(run: RunRecord) -> Mapping[Owner, Source]:
    """Return the lines of each kernel with what they cost on all cores."""
    records: defaultdict[Owner, list[KernelRecord]] = defaultdict(list)
    for each in run.kernels:
        records[Owner(each.stage, each.kernel, each.symbol)].append(each)
    stalls = _stalls(run)
    return {owner: _source(owner, same, stalls) for owner, same in records.items()}


def _stalls(run: RunRecord) -> Mapping[CostedLine, Counter[Stall]]:
    """Return the waits of lines for buffers."""
    found: defaultdict[CostedLine, Counter[Stall]] = defaultdict(Counter)
    for each in run.accesses:
        for reason, cclk in each.stall_cclk.items():
            if each.buffer:
                found[each.stage, each.symbol, each.line][Stall(reason.value, each.buffer)] += cclk
    return found


def _source(
    owner: Owner, records: Sequence[KernelRecord], stalls: Mapping[CostedLine, Counter[Stall]]
) -> Source:
    lines = (
        _line(each, stalls.get((owner.stage, owner.symbol, each.line), Counter()))
        for each in lines_of(records)
    )
    return Source(place=place_of(records[0]), lines=tuple(lines))


def _line(line: LineProfile, of_buffers: Counter[Stall]) -> Line:
    """Return a line with its waits. A wait for a buffer is listed under the buffer, and not under its reason alone."""
    stalls = Counter(of_buffers)
    for reason, cclk in line.cost.stall_cclk.items():
        stalls[Stall(reason.value, "")] += cclk
    for stall, cclk in of_buffers.items():
        stalls[Stall(stall.reason, "")] -= cclk
    return Line(
        text=line.text.strip(),
        number=line.line,
        times=line.executions,
        operations=dict(_operations(line)),
        stalls={stall: cclk for stall, cclk in stalls.items() if cclk},
    )


def _operations(line: LineProfile) -> Iterator[tuple[str, tuple[int, int]]]:
    """Yield the operations of a line; those without a kind of their own count as one."""
    for name, count in line.operations.items():
        yield name, (count, line.operations_cclk[name])
    left_cclk = line.cost.issue_cclk - line.operations_cclk.total()
    if left_cclk:
        yield "", (line.executions, left_cclk)
