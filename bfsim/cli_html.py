"""Options of `bfsim run` and `bfsim profile` for a page of all that a run tells."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from bfsim.errors import ConfigError
from bfsim.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.html.gantt import Gantts
    from bfsim.report.html.pictures import Pictures
    from bfsim.report.ldf.map import MemoryMap
    from bfsim.report.target import Target
    from bfsim.trace import Identity, RunRecord

_PACKAGES = ("altair", "jinja2", "markdown_it", "vl_convert")

Command = TypeVar("Command", bound=Callable[..., Any])


class _TargetType(click.ParamType["Target"]):
    """A frame rate or a frame time, such as 15Hz or 66ms."""

    name = "RATE|TIME"

    def convert(
        self, value: str | Target, param: click.Parameter | None, ctx: click.Context | None
    ) -> Target:
        """Return the target that is meant."""
        from bfsim.report.target import target_of

        if not isinstance(value, str):
            return value
        try:
            return target_of(value)
        except ConfigError as error:
            self.fail(str(error), param, ctx)


_PARAMETERS = (
    click.option(
        "--html",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Write all of it as one HTML page, too, with pictures and charts; it opens offline.",
    ),
    click.option(
        "--target",
        metavar="RATE|TIME",
        type=_TargetType(),
        help="Frame rate or frame time that the page compares each frame with, such as 15Hz or 66ms.",
    ),
)


def takes_html(command: Command) -> Command:
    """Give a command the options of `paging`."""
    for parameter in reversed(_PARAMETERS):
        command = parameter(command)
    return command


@contextmanager
def paging(
    watchers: Watchers,
    path: Path | None,
    target: Target | None,
    what: Mapping[str, Any],
    others: tuple[Path | None, ...] = (),
) -> Iterator[None]:
    """Have `watchers` write a page to `path`, if there is one, of the run that `what` describes.

    Raises ConfigError for a place that cannot be written, one of the `others` included, and where a package is missing.
    """
    if path is None:
        if target is not None:
            raise ConfigError("--target must come with --html FILE, whose page compares each frame with it")
        yield
        return
    from bfsim.report.save import require_apart, require_place

    require_place(path)
    require_apart(path, (what["recording"], what["ldf"], what["script"], *others))
    _require_packages()
    from bfsim.report.html.frames import MOST
    from bfsim.report.html.gantt import Gantts
    from bfsim.report.html.pictures import Pictures

    with Pictures() as pictures, Gantts() as gantts:

        def make_room(_identity: Identity, frames: int) -> None:
            pictures.frames = min(frames, MOST)

        watchers.before.extend((make_room, gantts.begin))
        watchers.seen.append(pictures.add)
        watchers.spans.append(gantts.add)
        watchers.done.append(partial(_write, path, target, pictures, gantts, what))
        yield


def _write(
    path: Path,
    target: Target | None,
    pictures: Pictures,
    gantts: Gantts,
    what: Mapping[str, Any],
    run: RunRecord,
) -> None:
    from bfsim.report.html.page import Page
    from bfsim.report.save import write_text
    from bfsim.shipped import accuracy_on

    gantts.finish()
    page = Page(
        run=run,
        pictures=pictures,
        gantts=gantts,
        accuracy=accuracy_on("In short"),
        unmodelled=accuracy_on("What is not modelled"),
        memory_map=_map_of(run, what),
        target=target,
    )
    write_text(path, page.chunks())


def _map_of(run: RunRecord, what: Mapping[str, Any]) -> MemoryMap:
    """Return where everything lay in a run."""
    from bfsim.mapping import map_memory
    from bfsim.recording import RecordingReader
    from bfsim.run import BUILT_IN_RECORDING, calibration_of

    with RecordingReader(what["recording"] or BUILT_IN_RECORDING) as reader:
        calibration = calibration_of(reader)
    given = ("firmware", "board", "settings", "profile", "defines", "include_dirs")
    return map_memory(
        what["ldf"],
        **{name: what[name] for name in given},
        width_px=run.identity.width_px,
        height_px=run.identity.height_px,
        calibration=calibration,
    )


def _require_packages() -> None:
    missing = [each for each in _PACKAGES if find_spec(each) is None]
    if missing:
        raise ConfigError(
            f'--html needs the package {missing[0]}; install all that it needs with: pip install "bfsim[html]"'
        )
