"""The page: the content of each of its parts, for the templates beside this file."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from markupsafe import Markup

from bfsim.files import store
from bfsim.report.budget.budget import budget_of
from bfsim.report.budget.start_up import start_up_cclk, without_start_up
from bfsim.report.budget.target import Target, kept_frames, slacks_of
from bfsim.report.budget.times import milliseconds
from bfsim.report.html.charts import cycle_stack, frames_a_bar, gantt, part_colours, row_colours, time_series
from bfsim.report.html.colours import MEANINGS
from bfsim.report.html.frames import facts_of, told_of, worst_of
from bfsim.report.html.gantt import Gantts
from bfsim.report.html.pictures import Pictures
from bfsim.report.html.rendering import data_of, html_of, rendered, script_of
from bfsim.report.html.sources import dearest_sources
from bfsim.report.ldf.drawing import drawing_of
from bfsim.report.ldf.map import MemoryMap
from bfsim.report.ldf.picture import svg_of
from bfsim.report.profile.buffers import buffers_of, traffic_of
from bfsim.report.run.screen import verdict
from bfsim.report.run.warnings import warnings_of
from bfsim.report.what_ran.configuration import configuration_of
from bfsim.trace import RunRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """Everything that a page shows of a run of at least one frame.

    `frames`: the number it was to have, which decided which ones are drawn. `accuracy` says how far to trust the
    numbers, and `unmodelled` what was left out, both in Markdown; `memory_map` is where everything lay.
    """

    run: RunRecord
    pictures: Pictures
    gantts: Gantts
    accuracy: str
    unmodelled: str
    memory_map: MemoryMap
    frames: int
    target: Target | None = None

    def chunks(self) -> Iterator[str]:
        """Yield the page as HTML, piece by piece."""
        return rendered("page.html", self._content())

    def _content(self) -> Mapping[str, Any]:
        run, hz = self.run, self.run.identity.cclk_hz
        budget = budget_of(without_start_up(run))
        told = told_of(run, self.frames)
        charts = {
            f"{name}-{core.core}": spec
            for number, core in enumerate(budget.cores)
            for name, spec in (
                ("series", time_series(run, number, self.target)),
                ("stack", cycle_stack(without_start_up(run), budget, core)),
            )
        }
        if self.gantts.tracks:
            charts["gantt"] = gantt(run, list(self.gantts.tracks))
        worst = worst_of(run)
        return {
            "run": run,
            "charts": charts,
            "budget": budget,
            "rate_hz": budget_of(run).frame_rate_hz,
            "verdict": verdict(run).plain,
            "warnings": warnings_of(run),
            "target": self.target,
            "slacks": slacks_of(run, self.target),
            "kept": self.target and kept_frames(run, self.target),
            "start_up_ms": milliseconds(start_up_cclk(run), hz),
            "frames": facts_of(run, budget, told, self.target),
            "told": len(told),
            "frames_a_bar": frames_a_bar(run),
            "worst": list(facts_of(run, budget, worst, self.target)),
            "pictures": self.pictures,
            "stage_colours": row_colours(run),
            "part_colours": part_colours(),
            "sources": dearest_sources(run),
            "buffers": buffers_of(run),
            "traffic": traffic_of(run),
            "map": Markup(svg_of(drawing_of(self.memory_map)).decode()),  # noqa: S704 - it escapes its words
            "configuration": list(configuration_of(run)),
            "accuracy": html_of(self.accuracy),
            "unmodelled": html_of(self.unmodelled),
            "meanings": {
                name: colour
                for name, colour in {**MEANINGS, **part_colours()}.items()
                if name in self.gantts.meanings
            },
            "ms": lambda cclk: milliseconds(cclk, hz),
            "data": data_of(
                {
                    "charts": charts,
                    "frames": [frame.index for frame in told],
                    "first": worst[0].index,
                    "gantts": {frame.index: self.gantts.chart(frame.index) for frame in told},
                }
            ),
            "library": script_of(_library()),
        }


def _library() -> str:
    """Return Vega, Vega-Lite and Vega-Embed as one script. Making it takes seconds, so it is kept in the cache."""
    import vl_convert

    said = "window.vegaEmbed = vegaEmbed; window.vega = vega;"
    name = hashlib.sha256(f"{version('vl-convert-python')} {said}".encode()).hexdigest()
    kept = store.load(name)
    if kept is None:
        kept = vl_convert.javascript_bundle(said).encode()
        store.save(name, kept)
    return kept.decode()
