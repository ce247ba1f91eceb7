"""The charts of a page in Vega-Lite: frame after frame, and the cycle stack of each stage."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import altair as alt

from bfsim.report.budget.budget import Budget, CoreBudget, StageRow
from bfsim.report.budget.rows import budget_rows, costs_of
from bfsim.report.budget.target import Target, most_used_cclk, used_cclk
from bfsim.report.budget.times import milliseconds
from bfsim.report.html.colours import IDLE, ISSUE, MEANINGS, STALLS, stage_colours
from bfsim.trace import RunRecord

Spec = dict[str, Any]

CHOSEN = "chosen"
"""The parameter of a chart that holds the index of the chosen frame."""

MOST_BARS = 300
"""The most bars that can be told apart: with more frames, a bar stands for the worst of several consecutive ones."""

BARS = "bars"
"""The name of the data of a Gantt chart."""

_BAR_HEIGHT = 26  # px
_TRACK_HEIGHT = 20  # px
_FRAMES_HEIGHT = 150  # px
_FONT = "system-ui, sans-serif"  # of the page: Vega measures words before it writes them
_INK, _GRID = "var(--ink)", "var(--line)"  # the page has a light and a dark value for each


def frames_a_bar(run: RunRecord) -> int:
    """Return how many frames each bar of a time series stands for."""
    return -(-len(run.frames) // MOST_BARS)


def time_series(run: RunRecord, number: int, target: Target | None) -> Spec:
    """Return a chart of what the core at `number` used of each frame, stage by stage, beside a target."""
    colours = row_colours(run)
    most_cclk = max(map(most_used_cclk, run.frames))
    top_ms = 1.05 * max(milliseconds(most_cclk, run.identity.cclk_hz), target.frame_ms if target else 0)
    bars = (
        alt.Chart(alt.Data(values=list(_used_ms(run, number))))
        .mark_bar(cursor="pointer")
        .encode(
            x=alt.X("frame:O", title="frame", axis=alt.Axis(labelOverlap=True, labelAngle=0)),
            y=alt.Y("sum(ms):Q", title="ms", scale=alt.Scale(domain=[0, top_ms])),
            color=alt.Color("stage:N", legend=None, scale=_scale(colours)),
            order=alt.Order("place:Q"),
            opacity=alt.condition(f"datum.frame == {CHOSEN}", alt.value(1), alt.value(0.6)),
            tooltip=["frame:O", "stage:N", alt.Tooltip("ms:Q", format=".2f")],
        )
        .add_params(alt.param(name=CHOSEN, value=run.frames[0].index))
    )
    return _spec(bars if target is None else bars + _rule(target), _FRAMES_HEIGHT)


def _used_ms(run: RunRecord, number: int) -> Iterator[dict[str, object]]:
    """Yield the ms of each stage without idling; of frames that share a bar, those of the worst."""
    rows, step = budget_rows(run), frames_a_bar(run)
    for start in range(0, len(run.frames), step):
        frame = max(run.frames[start : start + step], key=lambda each: used_cclk(each.cores[number]))
        for place, row in enumerate(rows):
            costs = costs_of(frame.cores[number], row, rows)
            cclk = sum(cost.elapsed_cclk - cost.idle_cclk for cost in costs)
            if cclk and row.within is None:
                ms = round(milliseconds(cclk, run.identity.cclk_hz), 4)
                yield {"frame": frame.index, "stage": row.stage, "ms": ms, "place": place}


def _rule(target: Target) -> alt.Chart:
    rule: alt.Chart = (
        alt.Chart(alt.Data(values=[{"ms": target.frame_ms}]))
        .mark_rule(color="var(--bad)", strokeDash=[6, 4], strokeWidth=1.5)
        .encode(y=alt.Y("ms:Q"))
    )
    return rule


def cycle_stack(run: RunRecord, budget: Budget, core: CoreBudget) -> Spec:
    """Return a chart of a core's mean frame: for each stage work, stalls by reason, and idling, in ms."""
    parts = [dict(_parts(row)) for row in core.rows if row.within is None]
    names = [row.name for row in core.rows if row.within is None]
    used = [name for name in part_colours() if any(part.get(name) for part in parts)]
    per_frame = len(run.frames) * run.identity.cclk_hz / 1000
    top = max(row.elapsed_cclk.total for each in budget.cores for row in each.rows) / per_frame
    values = [
        {"stage": name, "part": key, "ms": round(part[key] / per_frame, 4), "place": used.index(key)}
        for name, part in zip(names, parts, strict=True)
        for key in used
        if part.get(key)
    ]
    bars = (
        alt.Chart(alt.Data(values=values))
        .mark_bar(height=0.7 * _BAR_HEIGHT)
        .encode(
            y=alt.Y("stage:N", sort=names, title=None, axis=alt.Axis(labelLimit=110)),
            x=alt.X("sum(ms):Q", title="ms a frame", scale=alt.Scale(domain=[0, top])),
            color=alt.Color("part:N", legend=None, scale=_scale(part_colours(), used)),
            order=alt.Order("place:Q"),
            tooltip=["stage:N", "part:N", alt.Tooltip("ms:Q", format=".3f")],
        )
    )
    return _spec(bars, _BAR_HEIGHT * len({each["stage"] for each in values}))


def gantt(run: RunRecord, tracks: list[str]) -> Spec:
    """Return a chart of each core and device in a frame; its bars, `BARS`, are filled in when a frame is chosen."""
    stages = stage_colours(row.stage for row in budget_rows(run))
    colours = {**stages, **part_colours(), **MEANINGS}
    bars = (
        alt.Chart(alt.NamedData(BARS))
        .mark_bar(height=0.8 * _TRACK_HEIGHT)
        .encode(
            y=alt.Y("track:N", title=None, scale=alt.Scale(domain=tracks), axis=alt.Axis(labelLimit=120)),
            x=alt.X("begin:Q", title="ms from the beginning of the frame", scale=alt.Scale(nice=False)),
            x2="end:Q",
            color=alt.Color("means:N", legend=None, scale=_scale(colours)),
            opacity=alt.Opacity("busy:Q", legend=None, scale=alt.Scale(domain=[0, 1], range=[0.15, 1])),
            tooltip=[
                "track:N", "means:N", "name:N", alt.Tooltip("begin:Q", format=".2f"), alt.Tooltip("end:Q", format=".2f"),
                alt.Tooltip("busy:Q", format=".0%"),
            ],
        )
    )  # fmt: skip
    return _spec(bars, _TRACK_HEIGHT * len(tracks))


def row_colours(run: RunRecord) -> dict[str, str]:
    """Return the colours of the budget's rows that are not part of another: the same as in a Gantt chart."""
    rows = budget_rows(run)
    colours = stage_colours(row.stage for row in rows)
    return {row.stage: colours[row.stage] for row in rows if row.within is None}


def part_colours() -> dict[str, str]:
    """Return the colours of the kinds of cycles, in the order in which they are stacked."""
    return {"work": ISSUE, **{reason.value: colour for reason, colour in STALLS.items()}, "idle": IDLE}


def _parts(row: StageRow) -> Iterator[tuple[str, int]]:
    yield "work", row.issue_cclk
    yield from ((reason.value, cclk) for reason, cclk in row.stall_cclk.items())
    yield "idle", row.idle_cclk


def _scale(colours: dict[str, str], names: list[str] | None = None) -> alt.Scale:
    names = list(colours) if names is None else names
    return alt.Scale(domain=names, range=[colours[name] for name in names])


def _spec(chart: alt.Chart | alt.LayerChart, height: int) -> Spec:
    """Return a chart in the width that the page leaves for it, in the page's colours."""
    made: Spec = (
        chart.properties(
            width="container",
            height=height,
            background="transparent",
            autosize=alt.AutoSizeParams(type="fit-x", contains="padding"),
        )
        .configure(font=_FONT)
        .configure_view(stroke=None)
        .configure_mark(aria=False)
        .configure_axis(
            labelColor=_INK,
            titleColor=_INK,
            gridColor=_GRID,
            domainColor=_GRID,
            tickColor=_GRID,
            titleFontWeight="normal",
        )
        .to_dict()
    )
    return made
