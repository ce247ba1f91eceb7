"""Options of `bfsim run` and `bfsim profile` for other tools: a timeline for Perfetto, a flame graph for speedscope."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bfsim.cli.options.sets import takes
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.spans import Span
    from bfsim.trace import Identity, RunRecord


_PARAMETERS = (
    click.option(
        "--trace",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Write what each core and device did when, as a trace for ui.perfetto.dev, such as run.pftrace.",
    ),
    click.option(
        "--flame",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Write the cycles by core, stage and path of calls as a flame graph for speedscope.app, such as run.speedscope.json.",
    ),
)


takes_timelines = takes(_PARAMETERS)
"""Give a command the options of `timelines`."""


@contextmanager
def timelines(
    watchers: Watchers, trace: Path | None, flame: Path | None, others: Sequence[Path | None]
) -> Iterator[None]:
    """Have `watchers` write the files; each appears on a clean exit, or not at all.

    Raises ConfigError if a place cannot be written or is one of the `others`.
    """
    from bfsim.files.outputs import FLAME, TRACE, require_own
    from bfsim.files.save import require_apart, require_place

    for path, beside, output in ((trace, flame, TRACE), (flame, trace, FLAME)):
        if path:
            require_place(path)
            require_apart(path, (beside, *others))
            require_own(path, output)
    if flame:
        watchers.done.append(partial(_write_flame, flame))
    with _tracing(watchers, trace) if trace else nullcontext():
        yield


@contextmanager
def _tracing(watchers: Watchers, path: Path) -> Iterator[None]:
    from bfsim.files.save import growing_file, writing
    from bfsim.report.viewers.perfetto import PerfettoTrace

    traces: list[PerfettoTrace] = []
    with growing_file(path) as stream:

        def begin(identity: Identity, _frames: int) -> None:
            traces.append(PerfettoTrace(stream, identity.cclk_hz))

        def add(spans: Sequence[Span]) -> None:
            with writing(path):
                traces[0].add(spans)

        def end(_run: RunRecord) -> None:
            with writing(path):
                traces[0].flush()

        watchers.before.append(begin)
        watchers.spans.append(add)
        watchers.done.append(end)
        yield


def _write_flame(path: Path, run: RunRecord) -> None:
    from bfsim.files.save import write_text
    from bfsim.report.viewers.speedscope import speedscope_json

    write_text(path, speedscope_json(run))
