"""The main points of a profile, said first: the stage, the kernel, and what memories and waits cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from bfsim.report.budget.bound import bound_of
from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.start_up import without_start_up
from bfsim.report.budget.times import milliseconds
from bfsim.report.budget.waits import busy_cclk, other_core_cclk
from bfsim.report.profile.buffers import buffers_of
from bfsim.report.profile.cost import Cost, sum_of
from bfsim.report.profile.costs import OwnerProfile, Profile, cores_of, profile_of
from bfsim.report.profile.lines import together
from bfsim.trace import REST, RunRecord, StallReason

DMA = "DMA"
GROUPS: Mapping[str, frozenset[StallReason]] = {
    "the other core": frozenset({StallReason.SEMAPHORE}),
    DMA: frozenset({StallReason.DMA_SETUP, StallReason.RING_EMPTY, StallReason.RING_FULL}),
    "interrupts": frozenset({StallReason.INTERRUPT}),
    "interlocks": frozenset({StallReason.INTERLOCK}),
}
"""Stalls that do not concern memory, by what the core waits for."""
MEMORY = frozenset(StallReason) - frozenset[StallReason]().union(*GROUPS.values())
SLIGHT = 0.0005
"""Smaller shares of the whole are not mentioned: they would be 0.0 %."""
EXACT = 100
"""From this number on, there are no decimals."""
TEXT = 40
"""The most characters of a quoted source line."""


def sentences_of(run: RunRecord, core: str | None = None, stage: str | None = None) -> tuple[str, str, str]:
    """Return three sentences about one core, in one row of the budget or in all of them.

    Unless a core is given, it is the one that bounds the frame rate, or the one that is busiest in the row.
    """
    name = core or _busiest(run, stage)
    profile = profile_of(run, name, stage)
    first = _of_frame(run, profile, name) if stage is None else _of_stage(run, profile, name, stage)
    profile.whole = profile.cost
    if not profile.whole.elapsed_cclk:
        return first, "No kernel ran in it.", "It waited for nothing."
    return first, _of_kernels(profile), _of_waits(run, profile, name, stage)


def _busiest(run: RunRecord, stage: str | None) -> str:
    if stage is None:
        return bound_of(budget_of(without_start_up(run))).core.core
    return max(cores_of(run), key=lambda core: busy_cclk([profile_of(run, core, stage).cost]))


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.0995 else f"{100 * share:.1f} %"


def _number(value: float) -> str:
    """Return a number with three digits, or with all digits before the point."""
    return f"{value:,.0f}" if value >= EXACT else f"{value:.3g}"


def _ms(run: RunRecord, profile: Profile, cost: Cost) -> str:
    return f"{milliseconds(cost.elapsed_cclk, run.identity.cclk_hz) / profile.frames:.2f} ms"


def _of_stage(run: RunRecord, profile: Profile, core: str, stage: str) -> str:
    if not profile.cost.elapsed_cclk:
        return f"{stage} took no time on core {core}."
    share = _percent(profile.share(profile.cost.elapsed_cclk))
    return f"{stage} takes {_ms(run, profile, profile.cost)} a frame on core {core}, {share} of its frame."


def _of_frame(run: RunRecord, profile: Profile, core: str) -> str:
    within = {each.stage: each.within for each in run.rows}
    parts: Counter[str] = Counter()
    for each in profile.stages:
        row = within.get(each.stage) or each.stage
        parts["work outside of stages" if row == REST else row] += busy_cclk([each.cost])
    parts["waiting for pictures"] = profile.whole.idle_cclk
    parts["waiting for the other core"] = other_core_cclk(profile.whole)
    (name, cclk), *others = parts.most_common()
    told = [
        f"{other} {_percent(profile.share(cclk))}"
        for other, cclk in others[:2]
        if profile.share(cclk) >= SLIGHT
    ]
    then = f"; then {', '.join(told)}" if told else ""
    frame = _ms(run, profile, profile.whole)
    if profile.frames == 1 and profile.whole.idle_cclk:
        frame += " with the wait for the first picture"
    return f"{_percent(profile.share(cclk))} of core {core}'s frame ({frame}) is {name}{then}."


def _of_kernels(profile: Profile) -> str:
    kernels: dict[str, list[OwnerProfile]] = {}
    for each in (owner for stage in profile.stages for owner in stage.owners if owner.symbol):
        kernels.setdefault(each.symbol, []).append(each)
    if not kernels:
        return "No kernel ran in it."
    first = _in_all_stages(
        max(kernels.values(), key=lambda same: sum(each.cost.elapsed_cclk for each in same))
    )
    cclk = first.cost.elapsed_cclk
    text = f"The kernel that takes most is {first.owner} ({first.place}), {_percent(profile.share(cclk))}"
    if first.calls:
        count = _number(first.calls / profile.frames)
        calls = f"{count} {'call' if count == '1' else 'calls'} a frame of {cclk / first.calls:,.0f} cycles"
        text += f": {calls}{_of_lines(first)}"
    return f"{text}."


def _in_all_stages(same: Sequence[OwnerProfile]) -> OwnerProfile:
    """Return the cost of a kernel in several stages together."""
    return OwnerProfile(
        owner=same[0].owner,
        symbol=same[0].symbol,
        place=same[0].place,
        calls=sum(each.calls for each in same),
        cost=sum_of(each.cost for each in same),
        lines=together(line for each in same for line in each.lines),
    )


def _of_lines(kernel: OwnerProfile) -> str:
    """Say which line of a kernel takes most, and how often it runs in a call."""
    line = max(kernel.lines, key=lambda each: each.cost.elapsed_cclk, default=None)
    if line is None or not line.executions:
        return ""
    text = line.text.strip()
    quoted = text if len(text) <= TEXT else f"{text[: TEXT - 1]}…"
    share = _percent(line.cost.elapsed_cclk / kernel.cost.elapsed_cclk)
    turns = _number(line.executions / kernel.calls)
    often = "once" if turns == "1" else f"{turns} times"
    each = line.cost.elapsed_cclk / line.executions
    return f", {share} of them in line {line.line}, `{quoted}`, which runs {often} a call and takes {_number(each)} each time"


def _of_waits(run: RunRecord, profile: Profile, core: str, stage: str | None) -> str:
    stalls = profile.whole.stall_cclk
    memory_cclk = sum(stalls[each] for each in MEMORY)
    text = f"Memory costs {_percent(profile.share(memory_cclk))}"
    waited = [each for each in buffers_of(run, core, stage) if each.stalled_cclk]
    if profile.share(memory_cclk) >= SLIGHT and waited:
        most = waited[0]
        where = f"{most.buffer} in {most.memory}" if most.memory else "code outside L1"
        reason = max(most.stall_cclk, key=lambda each: most.stall_cclk[each])
        share = _percent(most.stalled_cclk / memory_cclk)
        text += f", {share} of that for {where}, mostly {reason.value}"
    others = {name: sum(stalls[each] for each in reasons) for name, reasons in GROUPS.items()}
    others["pictures"] = profile.whole.idle_cclk
    waits = [
        f"{name} {_percent(profile.share(cclk))}"
        for name, cclk in sorted(others.items(), key=lambda each: -each[1])
        if profile.share(cclk) >= SLIGHT
    ]
    return f"{text}; waits: {', '.join(waits)}." if waits else f"{text}; there are no other waits."
