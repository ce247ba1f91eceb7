"""What the firmware makes of real pictures: edges by band of rows, blobs, depth beside a dense matcher, balls by size.

`python -m benchmarks.real_pictures SET... [--size 320x240] [--pictures OUT]`: each SET is a folder of pictures, or holds
folders that are, or is a recording (whatever `bfsim record import` reads, calibrated or not). A folder with one stereo pair is
seen as such (`benchmarks/real/sets.py` says by which names), pictures with YOLO boxes beside them are searched for balls, all
others are seen by both cameras at once. `--pictures` keeps what was
seen as overlays. Defaults of the firmware are set by reasoning and on several sources, never by search on these pictures:
new folders are the judges. Needs OpenCV.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from rich.table import Table

from benchmarks.playing import Played, play
from benchmarks.real import balls, depth, edges
from benchmarks.real.sets import PICTURES, VIDEOS, PictureSet, read_recording, read_set
from bfsim.api import Seen
from bfsim.process.terminal import print_report, progress_bar
from bfsim.report.overlay.files import OverlayWriter
from bfsim.report.tables.table import new_table, stacked
from bfsim.seen import SeenFrame
from tinyphoon import ROWS, tinyphoon
from tinyphoon.view.view import view

CCLK_PER_MS = 600_000


@dataclass(frozen=True, slots=True)
class SeenSet:
    """A set of pictures, and what both cameras made of each frame; of stereo pairs also with each edge matched alone."""

    pictures: PictureSet
    played: Sequence[Played[Seen]]
    alone: Sequence[Played[Seen]]

    @property
    def cameras(self) -> list[tuple[Seen, ...]]:
        """What was seen, frame by frame; of one picture that both cameras have, once."""
        every = [tuple(each.taken.values()) for each in self.played]
        return every if self.pictures.is_stereo else [each[:1] for each in every]


def sets_in(folder: Path) -> list[Path]:
    """Return the folders with pictures or videos, this one or those in it; of a recording, itself."""
    if folder.is_file():
        return [folder]
    wanted = PICTURES | VIDEOS
    every = (folder, *sorted(each for each in folder.iterdir() if each.is_dir()))
    return [each for each in every if any(file.suffix.lower() in wanted for file in each.iterdir())]


def see(path: Path, size: tuple[int, int]) -> SeenSet:
    """Play a recording, or the pictures of a folder."""
    pictures = read_set(path, size) if path.is_dir() else read_recording(path)
    firmware = tinyphoon.calibrated(pictures.calibration)
    with progress_bar(f"Simulating {pictures.name}") as progress:
        done = iter(range(1, len(pictures.frames) + 1))
        played = play(pictures.frames, firmware, view, lambda _: progress(next(done), len(pictures.frames)))
        alone = play(pictures.frames, firmware, view, script=depth.ALONE) if pictures.is_stereo else ()
    return SeenSet(pictures, played, alone)


def edge_table(sets: Sequence[SeenSet]) -> Table:
    """Return a row a set."""
    table = new_table(edges.TITLE, "Set", "pictures", *edges.COLUMNS)
    table.caption, table.caption_justify = edges.NOTE, "left"
    for each in sets:
        seen = [one for cameras in each.cameras for one in cameras]
        table.add_row(each.pictures.name, f"{len(seen)}", *edges.cells(seen))
    return table


def depth_table(sets: Sequence[SeenSet]) -> Table:
    """Return rows of the stereo pairs."""
    table = new_table(depth.TITLE, "Set", *depth.COLUMNS)
    table.caption, table.caption_justify = depth.NOTE, "left"
    for each in sets:
        if each.pictures.is_stereo:
            for row in depth.rows_of(each.pictures, each.played, each.alone):
                table.add_row(each.pictures.name, *row)
    return table


def cost_table(sets: Sequence[SeenSet]) -> Table:
    """Return what each set cost and what was found besides edges, a picture."""
    stages = [row.stage for row in ROWS if row.within is None]
    table = new_table("Core A, median ms a frame, and features a picture", "Set", *stages, "blobs", "lines")
    for each in sets:
        costs = [frame.stages_cclk("A") for frame in each.played]
        medians = (np.median([cost.get(stage, 0) for cost in costs]) / CCLK_PER_MS for stage in stages)
        seen = [one for cameras in each.cameras for one in cameras]
        counts = (np.mean([len(one.blobs) for one in seen]), np.mean([len(one.lines) for one in seen]))
        table.add_row(each.pictures.name, *(f"{ms:.1f}" for ms in medians), *(f"{one:.1f}" for one in counts))
    return table


def ball_table(folder: Path) -> Table:
    """Return how many balls of a folder with boxes are found."""
    table = new_table(f"{balls.TITLE} ({folder.name})", *balls.COLUMNS)
    table.caption, table.caption_justify = balls.NOTE, "left"
    for row in balls.rows_of(folder):
        table.add_row(*row)
    return table


def draw(seen: SeenSet, folder: Path) -> None:
    """Keep what was seen in a set as overlays."""
    with OverlayWriter(folder / seen.pictures.name) as writer:
        for frame, each in zip(seen.pictures.frames, seen.played, strict=True):
            times_ns = {"left": frame.left_ns, "right": frame.right_ns}
            writer.add(SeenFrame(index=frame.index, times_ns=times_ns, cameras=tuple(each.taken.values())))


@click.command()
@click.argument("sets", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--size", default="320x240", show_default=True, help="Size of the recorded frames.")
@click.option("--pictures", type=click.Path(path_type=Path), help="Keep overlays in this folder.")
def main(sets: tuple[Path, ...], size: str, pictures: Path | None) -> None:
    """Print what the firmware makes of the pictures in SETS."""
    width, height = (int(each) for each in size.split("x"))
    found = [one for each in sets for one in sets_in(each)]
    if not found:
        raise click.UsageError(
            f"SETS must be recordings or folders with pictures, but in {', '.join(map(str, sets))} are none"
        )
    seen = [see(each, (width, height)) for each in found]
    tables = [edge_table(seen), cost_table(seen)]
    if any(each.pictures.is_stereo for each in seen):
        tables.append(depth_table(seen))
    tables += [ball_table(each) for each in found if any(each.glob("*.txt"))]
    print_report(stacked(*tables))
    if pictures:
        pictures.mkdir(parents=True, exist_ok=True)
        for one in seen:
            draw(one, pictures)


if __name__ == "__main__":
    main()
