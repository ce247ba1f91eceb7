"""Options of `bfsim run` and `bfsim profile` for a page of all that a run tells."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.sets import takes
from bfsim.errors import ConfigError
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.budget.target import Target


class _TargetType(click.ParamType["Target"]):
    """A frame rate or a frame time, such as 15Hz or 66ms."""

    name = "RATE|TIME"

    def convert(
        self, value: str | Target, param: click.Parameter | None, ctx: click.Context | None
    ) -> Target:
        """Return the target for a frame rate or frame time."""
        from bfsim.report.budget.target import target_of

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
        help="Also write everything as one HTML page with pictures and charts, which opens offline.",
    ),
    click.option(
        "--target",
        metavar="RATE|TIME",
        type=_TargetType(),
        help="Compare frames with this frame rate or frame time, such as 15Hz or 66ms.",
    ),
)


takes_html = takes(_PARAMETERS)
"""Give a command the options of `writing_page`."""


def require_told(target: Target | None, html: Path | None, *, is_json_only: bool) -> None:
    """Raise ConfigError for a target that no output would show."""
    if target and is_json_only and not html:
        raise ConfigError(
            "--target must come with the tables or --html FILE, and --json alone prints neither"
        )


@contextmanager
def writing_page(
    watchers: Watchers,
    path: Path | None,
    target: Target | None,
    what: Mapping[str, Any],
    others: tuple[Path | None, ...] = (),
) -> Iterator[None]:
    """Have `watchers` write a page to `path`, if there is one, of the run that `what` describes.

    Raises ConfigError if the place cannot be written or is one of the `others`, or if a package is missing.
    """
    if path is None:
        yield
        return
    from bfsim.run_page import paged, require_page
    from bfsim.running.inputs import files_of_run

    require_page(path, (*files_of_run(what), *others))
    with paged(watchers, path, target, what):
        yield
