"""Compare two runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from bfsim.errors import ConfigError
from bfsim.report.diff.contributions import contributions_of
from bfsim.report.diff.difference import NOTHING, Change, Difference, FrameChange, SeenChange
from bfsim.report.diff.result_side import result_side
from bfsim.report.diff.side import FRAMES, SEPARATOR, Side
from bfsim.report.results.result import Result
from bfsim.trace import DIGITS_SHOWN

CONTENT = ": content"
RECORDING_CONTENT = f"recording{CONTENT}"


def difference_of(before: Result, after: Result) -> Difference:
    """Compare two runs in the frames that both have; raise ConfigError if they have none."""
    frames = {each.index for each in before.run.frames} & {each.index for each in after.run.frames}
    if not frames:
        raise ConfigError("the two runs must have frames in common to be compared, but have none")
    return difference_between(result_side(before, frames), result_side(after, frames))


def difference_between(before: Side, after: Side) -> Difference:
    """Compare two sides; if the numbers of frames differ, the cycles of the first are scaled to those of the second."""
    measured = len(before.frames)
    if measured != len(after.frames):
        before = before.scaled(Fraction(len(after.frames), measured))
    has_lines = bool(before.sources and after.sources) or not (before.sources or after.sources)
    if not has_lines:
        before, after = before.without_lines(), after.without_lines()
    parts = contributions_of(before, after)
    return Difference(
        configuration=(*_configuration(before, after), *_moved(before.memories, after.memories)),
        frames=after.frames,
        measured_frames=measured,
        has_lines=has_lines,
        before_ms=before.frame_ms,
        after_ms=after.frame_ms,
        before_cclk_hz=before.cclk_hz,
        after_cclk_hz=after.cclk_hz,
        before_cclk=before.cclk,
        after_cclk=after.cclk,
        stages=tuple(each for each in parts if each.cclk or each.parts),
        changed_frames=_changed_frames(before.frame_cclk, after.frame_cclk),
        results=tuple(_results(before.results, after.results)) if measured == len(after.frames) else (),
        seen=tuple(_seen(before, after)),
    )


def _configuration(before: Side, after: Side) -> Iterator[Change]:
    as_many = before.configuration.get(FRAMES) == after.configuration.get(FRAMES)
    for what, text in before.configuration.items():
        old, new = text, after.configuration.get(what, text)
        if old == new or (what == RECORDING_CONTENT and not as_many):
            continue
        if what.endswith(("files", "numbers")):
            one, other = old.split(SEPARATOR), new.split(SEPARATOR)
            old = SEPARATOR.join(each for each in one if each not in other)
            new = SEPARATOR.join(each for each in other if each not in one)
        cut = DIGITS_SHOWN if what.endswith(CONTENT) else None
        yield Change(what=what, before=old[:cut] or NOTHING, after=new[:cut] or NOTHING)


def _moved(before: Mapping[str, str], after: Mapping[str, str]) -> Iterator[Change]:
    """Yield the buffers that moved to another memory."""
    for buffer, memory in before.items():
        if after.get(buffer, memory) != memory:
            yield Change(what=f"buffer {buffer}", before=memory, after=after[buffer])


def _changed_frames(olds: Mapping[int, int], news: Mapping[int, int]) -> tuple[FrameChange, ...]:
    """Return the frames that changed, the one that changed most first."""
    changed = [
        FrameChange(index=index, before_cclk=old, after_cclk=news[index])
        for index, old in olds.items()
        if news.get(index, old) != old
    ]
    return tuple(sorted(changed, key=lambda each: (-abs(each.after_cclk - each.before_cclk), each.index)))


def _results(
    before: Mapping[str, Sequence[int | None]], after: Mapping[str, Sequence[int | None]]
) -> Iterator[Change]:
    for name in dict.fromkeys([*before, *after]):
        old, new = before.get(name, []), after.get(name, [])
        is_other = list(old) != list(new) if len(old) == len(new) else _total(old) != _total(new)
        if is_other:
            yield Change(what=name, before=_total(old), after=_total(new))


def _total(values: Sequence[int | None]) -> str:
    known = [each for each in values if each is not None]
    return f"{sum(known):,}" if known else NOTHING


def _seen(before: Side, after: Side) -> Iterator[SeenChange]:
    """Yield what only one of the runs saw, if both have a view."""
    told = sorted(set(before.seen) & set(after.seen))
    for gone, one, other in ((True, before, after), (False, after, before)):
        found: dict[str, list[int]] = {}
        for index in told:
            for name, count in (one.seen[index] - other.seen[index]).items():
                found.setdefault(name, []).extend([index] * bool(count))
        for name, where in found.items():
            yield SeenChange(name=name, gone=gone, frames=len(where), first=where[0])
