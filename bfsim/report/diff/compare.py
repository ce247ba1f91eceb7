"""Comparing two runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from bfsim.errors import ConfigError
from bfsim.report.budget import budget_of
from bfsim.report.diff.contributions import stage_contributions
from bfsim.report.diff.difference import Change, Difference, FrameChange, SeenChange
from bfsim.report.result_file import Result
from bfsim.trace import FrameRecord, Identity

DIGEST_SHOWN = 12
"""Digits of a digest that are shown."""


def difference_of(before: Result, after: Result) -> Difference:
    """Compare two runs in the frames that both have; raise ConfigError if they have none."""
    old, new = before.run, after.run
    frames = [each.index for each in new.frames if each.index in {frame.index for frame in old.frames}]
    if not frames:
        raise ConfigError("the two runs must have frames of the same number to be compared, and have none")
    has_lines = len(frames) == len(old.frames) == len(new.frames)
    olds, news = _chosen(old.frames, frames), _chosen(new.frames, frames)
    stages = stage_contributions(before, after, frames, has_lines=has_lines)
    return Difference(
        configuration=tuple(_configuration(old.identity, new.identity)),
        frames=tuple(frames),
        has_lines=has_lines,
        before_ms=1000 / budget_of(old).frame_rate_hz,
        after_ms=1000 / budget_of(new).frame_rate_hz,
        before_hz=old.identity.cclk_hz,
        after_hz=new.identity.cclk_hz,
        before_cclk=sum(_cclk(each) for each in olds),
        after_cclk=sum(_cclk(each) for each in news),
        stages=tuple(each for each in stages if each.cclk or each.parts),
        changed_frames=_changed_frames(olds, news),
        results=tuple(_results(olds, news)),
        seen=tuple(_seen(before.seen, after.seen, frames)),
    )


def _chosen(frames: tuple[FrameRecord, ...], indexes: list[int]) -> list[FrameRecord]:
    return [each for each in frames if each.index in set(indexes)]


def _cclk(frame: FrameRecord) -> int:
    return sum(core.end_cclk - core.begin_cclk for core in frame.cores)


def _longest_cclk(frame: FrameRecord) -> int:
    return max(core.end_cclk - core.begin_cclk for core in frame.cores)


def _configuration(before: Identity, after: Identity) -> Iterator[Change]:
    for field in fields(Identity):
        old, new = getattr(before, field.name), getattr(after, field.name)
        if old == new:
            continue
        if field.name == "firmware_files":
            old, new = (
                ", ".join(sorted(set(one) - set(other))) or "-" for one, other in ((old, new), (new, old))
            )
        what = field.name.replace("_digest", ": content").replace("_", " ")
        cut = DIGEST_SHOWN if field.name.endswith("_digest") else None
        yield Change(what=what, before=str(old)[:cut] or "-", after=str(new)[:cut] or "-")


def _changed_frames(olds: list[FrameRecord], news: list[FrameRecord]) -> tuple[FrameChange, ...]:
    """Return the frames that changed, the one that changed most first."""
    pairs = zip(olds, news, strict=True)
    changes = [
        FrameChange(index=new.index, before_cclk=_longest_cclk(old), after_cclk=_longest_cclk(new))
        for old, new in pairs
    ]
    changed = [each for each in changes if each.before_cclk != each.after_cclk]
    return tuple(sorted(changed, key=lambda each: (-abs(each.after_cclk - each.before_cclk), each.index)))


def _results(olds: list[FrameRecord], news: list[FrameRecord]) -> Iterator[Change]:
    names = dict.fromkeys(name for frame in (*olds, *news) for name in frame.results)
    for name in names:
        old, new = ([frame.results.get(name) for frame in frames] for frames in (olds, news))
        if old != new:
            yield Change(what=name, before=_total(old), after=_total(new))


def _total(values: list[int | None]) -> str:
    known = [each for each in values if each is not None]
    return f"{sum(known):,}" if known else "-"


def _seen(
    before: Mapping[int, Mapping[str, Any]], after: Mapping[int, Mapping[str, Any]], frames: list[int]
) -> Iterator[SeenChange]:
    """Yield what only one of the runs saw, where both tell."""
    told = [index for index in frames if index in before and index in after]
    for gone, one, other in ((True, before, after), (False, after, before)):
        found: dict[str, list[int]] = {}
        for index in told:
            for name, count in (_names(one[index]) - _names(other[index])).items():
                found.setdefault(name, []).extend([index] * bool(count))
        for name, where in found.items():
            yield SeenChange(name=name, gone=gone, frames=len(where), first=where[0])


def _names(seen: Mapping[str, Any]) -> Counter[str]:
    return Counter(each["name"] for each in seen["objects"])
