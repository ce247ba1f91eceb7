"""What else might explain T Table 6.4: other readings of the thesis, and other programs with the right sum.

`python -m benchmarks.robot.readings FOLDER`: a folder of recordings of `bfsim record render thesis FOLDER`. Each is the
firmware `thesis` with one step of another reading, or today's firmware with another compiler or placement, on the scene
of Figure 6.7.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import click

from benchmarks.robot import steps
from benchmarks.robot.recordings import write_black, write_free
from benchmarks.table_6_4 import COLUMNS, FITTED, FRAME, PLAIN, ROWS, Setting, Times, robot_times, times
from bfsim.api import Firmware
from bfsim.process.terminal import print_report
from bfsim.report.tables.table import new_table
from bfsim.shipped import LDF_FOLDER
from tinyphoon import thesis, tinyphoon
from tinyphoon.stages.circle_detection import circle_detection
from tinyphoon.stages.colour_reduction import join_groups
from tinyphoon.stages.line_detection import scan_by_labels
from tinyphoon.stages.rectification import rectification
from tinyphoon.strategy.models import MODELS, ObjectModel, Shape
from tinyphoon.variants import THESIS, mains

SLOWER = "cm-bf561-500-100"
LEAST_BLOBS = "ball-too-close"
"""The column in which the robot's blobs took the least time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A firmware and how it is run; `others`: why what it makes is not the robot's, besides its rows."""

    title: str
    firmware: Firmware
    setting: Setting = PLAIN
    options: Mapping[str, Any] = field(default_factory=dict)
    scene: str = FITTED
    recording: Path | None = None
    """In place of the scene's."""


def read_as(title: str, scene: str = FITTED, **step: Any) -> Reading:
    """Return the firmware `thesis` with other steps."""
    return Reading(title=title, firmware=replace(thesis, mains=mains(replace(THESIS, **step))), scene=scene)


OF_THE_THESIS = (
    Reading(title="the firmware `thesis`", firmware=thesis),
    read_as("no rectification", rectification=rectification),
    read_as("rectification: the table comes by DMA", rectification=steps.rectification_by_dma_tables),
    read_as("rectification: byte by byte", rectification=steps.rectification_by_bytes),
    read_as(
        "edges: every pixel has a direction, weak ones go last", edge_detection=steps.edges_of_all_pixels
    ),
    read_as(
        "colours: root and hue of each pixel, not of each pair", edge_detection=steps.colours_of_each_pixel
    ),
    read_as("roots: by the routine of [Tur94] as it is printed", edge_detection=steps.edges_by_tur94),
    read_as("colours: those of a model are one", colour_groups=join_groups),
    read_as("opening: loops of T Eq. 2.14 and 2.15 over lines in L1", open_closing=steps.looped_opening),
    read_as("blobs: lines of picture and labels by DMA", blob_detection=steps.blobs_on_dma_lines),
    read_as("blobs: counted in a pass of its own", blob_detection=steps.blobs_in_three_passes),
    read_as("blobs: all colours at once", blob_detection=steps.blobs_of_all_colours_at_once),
    read_as("lines: by the labels of the row above", line_scan=scan_by_labels),
    read_as("filter 1: eroded at edges only", circle_detection=circle_detection),
    read_as("filter 1: eroded straight from SDRAM", circle_detection=steps.circles_by_sdram_erosion),
    read_as(
        "filter 1: eroded for each ball (scene of Figure 6.10)",
        "ball-beside-robot",
        circle_detection=steps.circles_by_an_erosion_each,
    ),
    read_as(
        "circles: centres within 8 px (scene of Figure 6.10)",
        "ball-beside-robot",
        circle_detection=steps.circles_in_a_small_patch,
    ),
)


def other_programs(code_in_l2: Path) -> Iterator[Reading]:
    """Yield what takes about as long for other reasons; `code_in_l2` is an LDF."""
    yield Reading(title="`tinyphoon`", firmware=tinyphoon)
    yield Reading(title="`tinyphoon`, code in L2", firmware=tinyphoon, options={"ldf": code_in_l2})
    yield Reading(title="`tinyphoon`, buffers in L2", firmware=tinyphoon, options={"ldf": "l2"})
    yield Reading(title="`tinyphoon`, buffers in SDRAM", firmware=tinyphoon, options={"ldf": "sdram"})
    yield Reading(title="`tinyphoon`, not optimised", firmware=tinyphoon, options={"profile": "gcc-O0"})
    yield Reading(title="`thesis`, not optimised", firmware=thesis, options={"profile": "gcc-O0"})
    yield Reading(title="`thesis`, the code GCC makes of it", firmware=thesis, options={"profile": "gcc-adi"})
    yield Reading(title="`thesis` at 500/100 MHz", firmware=thesis, setting=Setting(SLOWER, {}))


def write_models(script: Path, *models: ObjectModel) -> Path:
    """Write a script by which the strategy unit orders these models of the firmware's, and return it."""
    script.write_text(json.dumps({"send": [{"models": [{"name": each.name} for each in models]}]}))
    return script


def of_colours(folder: Path, recording: Path) -> Iterator[Reading]:
    """Yield what the time of blobs hangs on beside the picture: how many colours are sought, each in a pass of its own."""
    black = folder / "black.mcap"
    write_black(recording, black)
    unmarked = (each for each in MODELS if each.shape is not Shape.MARKER)
    without = {"script": write_models(folder / "no_marks.json", *unmarked)}
    of_one_team = {"script": write_models(folder / "one_team.json", *MODELS)}
    yield Reading(title="the marks of one team sought", firmware=thesis, options=of_one_team)
    yield Reading(title="a black picture", firmware=thesis, recording=black)
    yield Reading(
        title="no robots' marks sought, a black picture", firmware=thesis, options=without, recording=black
    )
    yield Reading(
        title="no robots' marks sought (scene of Figure 6.13)",
        firmware=thesis,
        options=without,
        scene=recording.stem,
    )


def of_free_cameras(folder: Path, recording: Path) -> Reading:
    """Return what it is worth that the cameras send pictures all the time, and each goes to SDRAM."""
    free = folder / "free.mcap"
    write_free(recording, free)
    options = {"feed": "cameras", "frames": None}
    title = "the cameras run free, each picture goes to SDRAM"
    return Reading(title=title, firmware=thesis, options=options, recording=free)


def write_code_in_l2(folder: Path) -> Path:
    """Write an LDF like thesis.ldf that has room for code in L2 only, and return it."""
    for name in ("thesis.ldf", "cm-bf561.ldfi", "core.ldfi"):
        shutil.copy(LDF_FOLDER / name, folder)
    core = folder / "core.ldfi"
    text, line = core.read_text(), "INPUT_SECTIONS($OBJECTS(program))\n"
    assert text.count(line) == 2  # both memories of code in L1
    core.write_text(text.replace(line, ""))
    return (folder / "thesis.ldf").rename(folder / "code-in-l2.ldf")


def measured(folder: Path) -> Iterator[tuple[str, Times]]:
    """Yield the robot's column of Figure 6.7, and what each reading makes of it."""
    yield f"robot ({COLUMNS[FITTED][0]})", robot_times(COLUMNS[FITTED][1])
    with ExitStack() as stack:
        placements = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        colours = of_colours(placements, folder / f"{LEAST_BLOBS}.mcap")
        free = of_free_cameras(placements, folder / f"{FITTED}.mcap")
        for each in (*OF_THE_THESIS, free, *colours, *other_programs(write_code_in_l2(placements))):
            recording = each.recording or folder / f"{each.scene}.mcap"
            yield each.title, times(recording, each.firmware, each.setting, **each.options)


@click.command(help=__doc__)
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
def main(folder: Path) -> None:
    """Print the table."""
    table = new_table("Other explanations of T Table 6.4", "ms of core A", *ROWS, FRAME)
    for title, found in measured(folder):
        table.add_row(title.replace("`", ""), *(f"{found[row]:.1f}" for row in (*ROWS, FRAME)))
    print_report(table)


if __name__ == "__main__":
    main()
