"""Options of `bfsim run` for what the firmware saw: pictures for people, files for machines."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bfsim.cli.options.sets import takes
from bfsim.errors import ConfigError, shown
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.recording.foxglove.seen_writer import SeenWriter
    from bfsim.seen import SeenFrame
    from bfsim.trace import RunRecord


ALL_STAGES = ""
"""The value of `--heat` without a stage."""


class _Layers(click.ParamType[tuple[str, ...]]):
    """Names of layers, such as edges,lines."""

    name = "NAME,..."

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, ...]:
        """Return the names."""
        from bfsim.report.overlay.layers import LAYERS

        named = tuple(each.strip() for each in value.split(","))
        if unknown := [each for each in named if each not in LAYERS]:
            self.fail(f"must be some of {', '.join(LAYERS)}, not {shown(unknown[0])}", param, ctx)
        return named


_PARAMETERS = (
    click.option("--show", is_flag=True, help="Draw what was seen over the pictures, and open the result."),
    click.option(
        "--overlay",
        metavar="DIR|FILE",
        type=click.Path(path_type=Path),
        help="Draw what was seen: a PNG per frame in DIR, or all in FILE, a .gif, .webp, .apng or (for long runs) .mp4.",
    ),
    click.option(
        "--layers",
        metavar="NAME,...",
        type=_Layers(),
        help="What --overlay and --show draw: some of edges, blobs, lines, circles, objects, losses, arrows, texts, map, above "
        "(the view from above).  [default: all]",
    ),
    click.option(
        "--heat",
        metavar="[STAGE]",
        is_flag=False,
        flag_value=ALL_STAGES,
        help="Draw where in the picture the time of STAGE, or of all stages, went: a heat map, and the cost of each row by stage. "
        "Only objects are drawn over it unless --layers says otherwise.",
    ),
    click.option(
        "--mcap",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Write pictures, features, objects, 3-D lines, 3-D edges, costs, stalls and warnings as an MCAP file for Foxglove and rerun.",
    ),
)


takes_views = takes(_PARAMETERS)
"""Give a command the options of `watching`."""


@contextmanager
def watching(
    watchers: Watchers,
    *,
    show: bool,
    overlay: Path | None,
    mcap: Path | None,
    layers: tuple[str, ...] | None,
    heat: tuple[str, ...] | None,
) -> Iterator[None]:
    """Have `watchers` write the files, which appear on a clean exit, or not at all.

    Raises a BfsimError if a place cannot be written, if two files have one place, or if layers are given but nothing is
    drawn.
    """
    if layers and not (show or overlay):
        raise ConfigError("--layers must come with --overlay DIR|FILE or --show, which draw them")
    if heat and not (show or overlay or mcap):
        raise ConfigError("--heat must come with --overlay DIR|FILE, --show or --mcap FILE, which show it")
    if mcap:
        from bfsim.files.save import require_apart

        require_apart(mcap, (overlay,))
    with ExitStack() as stack:
        tell: list[Callable[[SeenFrame], None]] = []
        if mcap:
            writer = stack.enter_context(_seen_writer(mcap))
            tell.append(writer.add)
            watchers.done.append(partial(_add_series, writer))
        if show and not overlay:
            overlay = stack.enter_context(_lasting_folder()) / "overlay.gif"
        if overlay:
            from bfsim.report.overlay.files import OverlayWriter
            from bfsim.report.overlay.layers import LAYERS, UNDER_HEAT

            drawn = layers or (UNDER_HEAT if heat else LAYERS)
            tell.append(stack.enter_context(OverlayWriter(overlay, drawn)).add)
        if heat:
            _heat_up(watchers, heat, tell)
        else:
            watchers.seen.extend(tell)
        yield
    if show and overlay:
        _show(overlay)


def _heat_up(watchers: Watchers, stages: Sequence[str], tell: Sequence[Callable[[SeenFrame], None]]) -> None:
    """Have `watchers` pass on each frame with its heat."""
    from bfsim.report.heat.frames import HeatedFrames

    frames = HeatedFrames(stages, tell)
    watchers.before.append(frames.begin)
    watchers.seen.append(frames.add)
    watchers.spans.append(frames.add_spans)


def stages_named(heat: str | None, firmware: str) -> tuple[str, ...] | None:
    """Return the stages that `--heat` asks for, all with ALL_STAGES; None without the option.

    Raises ConfigError if the firmware has no such stage.
    """
    if heat is None:
        return None
    from bfsim.loading.firmware import load_firmware
    from bfsim.report.heat.frames import stages_of

    rows = load_firmware(firmware).firmware.rows
    try:
        return stages_of(rows, None if heat == ALL_STAGES else heat)
    except KeyError:
        known = ", ".join(each.stage for each in rows)
        wanted = (
            f"be alone, for all stages, or name one of {known}"
            if known
            else "be alone: the firmware has no rows"
        )
        raise ConfigError(f"--heat must {wanted}, not {shown(heat)}; a RECORDING goes before it") from None


def _seen_writer(path: Path) -> SeenWriter:
    from bfsim.files.save import require_place
    from bfsim.recording.foxglove.seen_writer import SeenWriter

    require_place(path)
    return SeenWriter(path)


def _add_series(writer: SeenWriter, run: RunRecord) -> None:
    """Add the cost and the warnings of each frame to its pictures."""
    from bfsim.report.viewers.frame_series import notes_of, samples_of

    for sample in samples_of(run):
        if writer.has(sample.frame):
            writer.add_numbers(*sample)
    for note in notes_of(run):
        if writer.has(note.frame):
            writer.add_note(note.frame, note.text, is_warning=note.is_warning)


@contextmanager
def _lasting_folder() -> Iterator[Path]:
    """Yield a new folder among the temporary ones that stays, unless something goes wrong."""
    folder = Path(tempfile.mkdtemp(prefix="bfsim-"))
    try:
        yield folder
    except BaseException:
        shutil.rmtree(folder)
        raise


def _show(path: Path) -> None:
    """Print where a picture is and, if there is a display, open it with the system's program for it."""
    click.echo(f"bfsim: what was seen is drawn in {path}", err=True)
    if sys.platform in {"darwin", "win32"} or {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        click.launch(str(path))
