"""The page: what each of its parts shows, filled into the templates beside this file."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markdown_it import MarkdownIt
from markupsafe import Markup

from bfsim.report.budget import budget_of, milliseconds
from bfsim.report.configuration import configuration_of
from bfsim.report.html.charts import cycle_stack, frames_a_bar, gantt, part_colours, time_series
from bfsim.report.html.colours import MEANINGS, stage_colours
from bfsim.report.html.frames import facts_of, told_of, worst_of
from bfsim.report.html.gantt import Gantts
from bfsim.report.html.pictures import Pictures
from bfsim.report.html.sources import dearest_sources
from bfsim.report.ldf.drawing import drawing_of
from bfsim.report.ldf.map import MemoryMap
from bfsim.report.ldf.picture import svg_of
from bfsim.report.profile import profile_of
from bfsim.report.screen import verdict
from bfsim.report.start_up import start_up_cclk, without_start_up
from bfsim.report.target import Target, kept_frames, slacks_of
from bfsim.report.units import size
from bfsim.report.warnings import warnings_of
from bfsim.trace import RunRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """All that a page shows of a run of at least one frame.

    `accuracy` is what to say of how far to trust the numbers, and `unmodelled` what was left out, both in Markdown;
    `memory_map` is where everything lay.
    """

    run: RunRecord
    pictures: Pictures
    gantts: Gantts
    accuracy: str
    unmodelled: str
    memory_map: MemoryMap
    target: Target | None = None

    def chunks(self) -> Iterator[str]:
        """Yield the page as HTML, piece by piece."""
        environment = Environment(
            loader=PackageLoader("bfsim.report.html"),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        environment.filters |= {"size": size, "share": lambda part: f"{100 * part:.1f}"}
        return environment.get_template("page.html").generate(self._content(environment))

    def _content(self, environment: Environment) -> Mapping[str, Any]:
        run, hz = self.run, self.run.identity.cclk_hz
        budget = budget_of(without_start_up(run))
        told = told_of(run)
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
        stages = [row.name for row in budget.cores[0].rows if row.within is None]
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
            "stage_colours": {name: stage_colours(stages)[name] for name in stages},
            "part_colours": part_colours(),
            "sources": dearest_sources(run),
            "traffic": profile_of(run).traffic,
            "map": Markup(svg_of(drawing_of(self.memory_map)).decode()),  # noqa: S704 - it escapes its words
            "configuration": list(configuration_of(run)),
            "accuracy": Markup(_markdown(self.accuracy)),  # noqa: S704 - ours
            "unmodelled": Markup(_markdown(self.unmodelled)),  # noqa: S704 - ours
            "meanings": MEANINGS,
            "ms": lambda cclk: milliseconds(cclk, hz),
            "data": _json(
                {
                    "charts": charts,
                    "frames": [frame.index for frame in told],
                    "first": worst[0].index,
                    "gantts": {frame.index: self.gantts.chart(frame.index) for frame in told},
                }
            ),
            "library": _script_of(_library()),
            "style": _file(environment, "page.css"),
            "script": _file(environment, "page.js"),
        }


def _markdown(text: str) -> str:
    """Return Markdown as HTML without links: a page that stands by itself has nowhere to go."""
    html: str = MarkdownIt("commonmark", {"html": False}).disable("link").render(text)
    return html


def _library() -> str:
    """Return Vega, Vega-Lite and Vega-Embed as one script."""
    import vl_convert

    script: str = vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed; window.vega = vega;")
    return script


def _json(value: object) -> Markup:
    """Return data for a script element: no text in it can end the element."""
    return Markup(json.dumps(value, separators=(",", ":")).replace("<", "\\u003c"))  # noqa: S704 - escaped


def _script_of(text: str) -> Markup:
    return Markup(text.replace("</script", "<\\/script"))  # noqa: S704 - a library's


def _file(environment: Environment, name: str) -> Markup:
    """Return a file that stands beside the templates as it is."""
    assert environment.loader
    return Markup(environment.loader.get_source(environment, name)[0])  # noqa: S704 - ours
