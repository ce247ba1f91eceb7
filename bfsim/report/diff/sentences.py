"""The difference of two runs in a sentence or two: how large it is, and what causes most of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bfsim.report.diff.contributions import walk
from bfsim.report.diff.difference import NOTHING, Contribution, ContributionKind, Difference
from bfsim.report.diff.pairs import SMALL
from bfsim.report.wording.units import counted, mhz

MS_RESOLUTION = 1e-6
"""The resolution in which a baseline has the time of a frame, in ms."""


def verdict(difference: Difference) -> str:
    """Say by how much longer or shorter a frame takes."""
    before, after = difference.before_ms, difference.after_ms
    is_other = any(each.cclk for _, each in walk(difference.stages)) or difference.changed_frames
    if not is_other and abs(after - before) <= MS_RESOLUTION:
        return f"No difference: {after:.2f} ms a frame, every cycle of every frame as before."
    change = round(100 * (after / before - 1), 2) + 0.0  # avoids -0.00
    word = "slower" if change > 0 else "faster" if change < 0 else "as fast as before"
    return (
        f"{before:.2f} → {after:.2f} ms a frame ({change:+.2f} %, {word}): {1000 / before:.2f} → "
        f"{1000 / after:.2f} frames/s."
    )


def why(difference: Difference) -> Iterator[str]:
    """Yield the reasons: first what affects the counts of time and work, then what changed most."""
    yield from filter(None, (clock(difference), code(difference), work(difference), reason(difference)))


def clock(difference: Difference) -> str:
    """Say how another core clock changes the time of equal work; "" if the clock is the same.

    Waits for pictures do not change with it.
    """
    before, after = difference.before_cclk_hz, difference.after_cclk_hz
    if before == after:
        return ""
    change = 100 * (before / after - 1)
    told = f"{abs(change):.1f} % {'longer' if change > 0 else 'less time'}"
    return f"The core clock went from {mhz(before)} to {mhz(after)}: the same cycles take {told}."


def code(difference: Difference) -> str:
    """Say that kernels ran as code of another origin, though for the same compiler; "" if they did not."""
    changes = {each.what: each for each in difference.configuration}
    change = changes.get("code")
    is_asked_for = any(each.startswith("compiler") for each in changes)
    if change is None or is_asked_for or NOTHING in {change.before, change.after}:
        return ""
    return (
        f"The code of the kernels went from {change.before!r} to {change.after!r}, which makes a part of the difference, "
        "whatever was edited: compare runs of the same code, or with `--profile gcc-O2`, which estimates all of it."
    )


def work(difference: Difference) -> str:
    """Say how the work of all cores, without waits for other cores and the cameras, has changed; "" if it has not."""
    waits = next((each for each in difference.stages if each.kind is ContributionKind.FOLLOWS), None)
    if waits is None:
        return ""
    frames = len(difference.frames)
    before, after = (
        (cclk - (waited or 0)) * 1000 / (hz * frames)
        for cclk, waited, hz in (
            (difference.before_cclk, waits.before_cclk, difference.before_cclk_hz),
            (difference.after_cclk, waits.after_cclk, difference.after_cclk_hz),
        )
    )
    if f"{before:.2f}" == f"{after:.2f}":
        return ""
    return (
        f"Without waits for other cores and the cameras, all cores take {before:.2f} → {after:.2f} ms a frame "
        "together."
    )


def reason(difference: Difference) -> str:
    """Say where the largest contribution is, from the stage down to the cause; "" if there is no difference."""
    parts = [*largest(difference.stages)]
    places = [each for each in parts if each.kind is not ContributionKind.CAUSE]
    if not places:
        return ""
    told = "; in it ".join(f"{_named(each)} {counted(each.cclk, sign=True)}" for each in places)
    for cause in parts[len(places) :]:
        whole = cause.cclk == places[-1].cclk
        told += f" ({cause.name})" if whole else f" ({cause.name} {counted(cause.cclk, sign=True)})"
    return f"The largest part, in cycles of all cores: {told}."


def _named(contribution: Contribution) -> str:
    if contribution.kind is ContributionKind.LINE:
        return f"line {contribution.place.rpartition(':')[2]}"
    return f"{contribution.name} ({contribution.place})" if contribution.place else contribution.name


def largest(parts: Sequence[Contribution]) -> Iterator[Contribution]:
    """Yield the largest contribution with a name that follows from no other, then the largest in it, and so on."""
    own = [
        each
        for each in parts
        if each.kind is not ContributionKind.FOLLOWS and each.name != SMALL and each.cclk
    ]
    if own:
        most = max(own, key=lambda each: abs(each.cclk))
        yield most
        yield from largest(most.parts)
