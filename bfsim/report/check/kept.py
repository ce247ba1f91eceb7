"""What a run cost, as the baseline keeps it to explain later growth: owners and their lines, small ones added up."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from bfsim.report.check.baseline import Case, Costs, KeptLine, KeptOwner
from bfsim.report.check.figures import OBJECTS, RESULTS, Name
from bfsim.report.check.requirement_reading import parse_requirement
from bfsim.report.diff.pairs import SMALL
from bfsim.report.diff.result_side import result_side
from bfsim.report.diff.side import FRAMES, SEPARATOR, Line, Owner, Side, Source, Stall
from bfsim.report.results.result import Result

KEPT_SHARE = 0.001
"""An owner of cycles or a line is kept if it has at least this share of all work."""
FRAMES_KEPT = 20
"""The most frames for which the cycles of each are kept."""
BETWEEN = ", "
"""Separates the reason of a stall from the buffer."""


def whole_side(result: Result) -> Side:
    """Return all frames of a run as a side of a comparison."""
    return result_side(result, {each.index for each in result.run.frames})


def kept_costs(side: Side) -> Costs:
    """Return what the baseline keeps of a run's costs."""
    least = int(KEPT_SHARE * sum(side.owners.values()))
    owners = Counter[Owner]()
    for owner, cclk in side.owners.items():
        owners[owner if cclk >= max(least, 1) else Owner(owner.stage, SMALL, "")] += cclk
    memories: dict[str, list[str]] = {}
    for buffer, memory in sorted(side.memories.items()):
        memories.setdefault(memory, []).append(buffer)
    return Costs(
        frames=len(side.frames),
        frame_ms=round(side.frame_ms, 6),
        cclk_hz=side.cclk_hz,
        least_cclk=least,
        frame_cclk={str(index): cclk for index, cclk in side.frame_cclk.items()}
        if len(side.frames) <= FRAMES_KEPT
        else {},
        waits={stage: cclk for stage, cclk in side.waits.items() if cclk},
        memories=memories,
        of=[_kept(owner, cclk, side, least) for owner, cclk in owners.most_common() if cclk],
    )


def _kept(owner: Owner, cclk: int, side: Side, least: int) -> KeptOwner:
    source = side.sources.get(owner)
    return KeptOwner(
        stage=owner.stage,
        owner=owner.name,
        symbol=owner.symbol,
        place=source.place if source else "",
        cclk=cclk,
        lines=[_kept_line(each) for each in source.lines if each.cclk >= max(least, 1)] if source else [],
    )


def _kept_line(line: Line) -> KeptLine:
    return KeptLine(
        text=line.text,
        times=line.times,
        operations={name: list(both) for name, both in line.operations.items()},
        stalls={
            f"{stall.reason}{BETWEEN}{stall.buffer}" if stall.buffer else stall.reason: cclk
            for stall, cclk in line.stalls.items()
        },
    )


def kept_side(case: Case) -> Side:
    """Return a measured run as it was then."""
    costs, on = case.costs, case.measured_on
    assert costs is not None
    assert on is not None
    digests = {"recording", "board", "compiler", "script", "firmware", "ldf"}
    configuration = {
        f"{key}: content" if key in digests else key.replace("_", " "): str(value)
        for key, value in on.model_dump(
            include={*digests, "bfsim_version", "llvm_version", "code", "file_compiler"}
        ).items()
    } | {
        FRAMES: str(on.frames),
        "board numbers": SEPARATOR.join(on.board_numbers),
        "compiler numbers": SEPARATOR.join(on.compiler_numbers),
    }
    if case.recording:
        configuration["recording"] = Path(case.recording).name
    if on.width_px:
        configuration |= {"width px": str(on.width_px), "height px": str(on.height_px)}
    counts = dict(_counts(case))
    frames = list(map(int, costs.frame_cclk)) or list(range(costs.frames))
    return Side(
        configuration=configuration,
        cclk_hz=costs.cclk_hz,
        frame_ms=costs.frame_ms,
        frames=tuple(frames),
        owners={Owner(each.stage, each.owner, each.symbol): each.cclk for each in costs.of},
        waits=costs.waits,
        sources={
            Owner(each.stage, each.owner, each.symbol): Source(
                place=each.place, lines=tuple(_line(line) for line in each.lines)
            )
            for each in costs.of
            if each.symbol
        },
        memories={buffer: memory for memory, buffers in costs.memories.items() for buffer in buffers},
        frame_cclk={int(index): cclk for index, cclk in costs.frame_cclk.items()},
        results={name[1]: values for name, values in counts.items() if name[0] == RESULTS},
        seen=_seen({name[1]: values for name, values in counts.items() if name[0] == OBJECTS}, costs),
        least_cclk=costs.least_cclk,
    )


def _line(kept: KeptLine) -> Line:
    stalls = {Stall(*_split(key)): cclk for key, cclk in kept.stalls.items()}
    return Line(
        text=kept.text,
        times=kept.times,
        operations={name: (count, cclk) for name, (count, cclk) in kept.operations.items()},
        stalls=stalls,
    )


def _split(key: str) -> tuple[str, str]:
    reason, _, buffer = key.partition(BETWEEN)
    return reason, buffer


def _counts(case: Case) -> Iterator[tuple[Name, list[int]]]:
    """Yield the measured results: frame by frame, or in total."""
    for text in case.limits:
        each = parse_requirement(text, "")
        if each.name[0] in {RESULTS, OBJECTS} and each.statistic in {"", "total"}:
            yield each.name, [int(number) for number in each.numbers]


def _seen(objects: Mapping[str, Sequence[int]], costs: Costs) -> dict[int, Counter[str]]:
    """Return what was seen in each frame, if the baseline has it frame by frame and says which frames these are."""
    frames = list(map(int, costs.frame_cclk))
    if any(len(values) != len(frames) for values in objects.values()):
        return {}
    return {
        index: Counter({name: values[place] for name, values in objects.items()})
        for place, index in enumerate(frames)
    }
