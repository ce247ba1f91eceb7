"""A plot of a sweep: two columns of its table against each other, with the Pareto front."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Any

from bfsim.errors import ConfigError, cut, printable, shown
from bfsim.report.sweep.figures import FRAME_TIME, ON_CHIP
from bfsim.report.sweep.front import front, sign_of
from bfsim.report.sweep.table import Row, columns_of

Axes = tuple[str, str]
"""The columns of x and y."""

PARETO: Axes = (ON_CHIP, FRAME_TIME)
MOST_COLOURS = 10
"""The most settings that colours can tell apart."""
WIDTH_PX, HEIGHT_PX = 560, 360
EDGE_PX = 5
WIDER_PX = 2
"""How much wider a character of the legend may be in the viewer's font than in the font that measured the plot."""
_INK = "#555555"


def axes_of(text: str) -> Axes:
    """Return the columns that x=COLUMN,y=COLUMN names. Raises ConfigError for anything else."""
    found = re.fullmatch(r"\s*x=(.+?)\s*,\s*y=(.+?)\s*", text)
    if found is None:
        raise ConfigError(
            f"must be x=COLUMN,y=COLUMN, such as x=on_chip B,y=frame.median ms, not {shown(text)}"
        )
    return found[1], found[2]


def plot_svg(points: Sequence[tuple[str, Row]], axes: Axes) -> str:
    """Return an SVG of points, given by setting and row; those that lack one of the columns are left out.

    The front is drawn if it is known for both columns whether more or less is better. Raises ConfigError for a column
    that does not exist or is empty.
    """
    import altair as alt
    import vl_convert

    rows = [row for _, row in points]
    columns = columns_of(rows)
    for name in axes:
        _require_column(name, columns)
    texts = columns[axes[0]], columns[axes[1]], [setting for setting, _ in points]
    cells = list(zip(*(map(_drawable, each) for each in texts), strict=True))
    values = [
        {"x": x, "y": y, "setting": setting} for x, y, setting in cells if x is not None and y is not None
    ]
    if not values:
        raise ConfigError(f"--plot: no point has both {axes[0]} and {axes[1]}")
    x, y = (
        _channel(kind, name, [each[key] for each in values])
        for kind, name, key in ((alt.X, axes[0], "x"), (alt.Y, axes[1], "y"))
    )
    settings = list(dict.fromkeys(str(each["setting"]) for each in values))
    colour = (
        alt.Color("setting:N", sort=settings, title=None, legend=alt.Legend(labelLimit=0))
        if 1 < len(settings) <= MOST_COLOURS
        else alt.value("#4c78a8")
    )
    chart: Any = (
        alt.Chart(alt.Data(values=values)).mark_circle(size=60, opacity=0.8).encode(x=x, y=y, color=colour)
    )
    ends = _front(values, axes)
    if ends:
        line = alt.Chart(alt.Data(values=ends)).mark_line(
            color=_INK, strokeDash=[4, 3], interpolate="step-after"
        )
        chart = line.encode(x="x:Q", y="y:Q", order="place:Q") + chart
    right = EDGE_PX + WIDER_PX * max(map(len, settings))
    edges = {"left": EDGE_PX, "top": EDGE_PX, "right": right, "bottom": EDGE_PX}
    sized = chart.properties(width=WIDTH_PX, height=HEIGHT_PX, padding=edges)
    svg: str = vl_convert.vegalite_to_svg(sized.to_dict())
    return svg


def _drawable(cell: Any) -> Any:
    """Return a number unchanged, and text without characters that XML cannot hold."""
    return printable(cell) if isinstance(cell, str) else cell


def _require_column(name: str, columns: dict[str, list[Any]]) -> None:
    if name not in columns:
        near = difflib.get_close_matches(name, columns, n=4, cutoff=0.3)
        raise ConfigError(
            f"--plot: there must be a column {cut(name)}; the nearest are {', '.join(near) or ', '.join(list(columns)[:4])}, "
            "and the first line of the CSV has all"
        )


def _channel(kind: Any, name: str, cells: Sequence[object]) -> Any:
    """Return a column as x or y: a scale for numbers, one place for each text."""
    import altair as alt

    is_number = not any(isinstance(each, str) for each in cells)
    field = ("x" if kind is alt.X else "y") + (":Q" if is_number else ":N")
    return kind(field, title=name, scale=alt.Scale(zero=False)) if is_number else kind(field, title=name)


def _front(values: Sequence[dict[str, Any]], axes: Axes) -> list[dict[str, float]]:
    """Return the places on the front in order; nothing if it is unknown what is better."""
    x_sign, y_sign = map(sign_of, axes)
    if not x_sign or not y_sign:
        return []
    places = [(x_sign * each["x"], y_sign * each["y"]) for each in values]
    return [
        {"x": values[each]["x"], "y": values[each]["y"], "place": place}
        for place, each in enumerate(front(places))
    ]
