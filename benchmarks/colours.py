"""What the firmware calls each colour of a picture: its 32 colours beside it, and the table of hues.

`python -m benchmarks.colours PICTURE OUT.png [--least-chroma N] [--eps-black N] [--eps-white N]`: thresholds that are not
given are those of the indoor field. In OUT.png every pixel has the middle of its hue, black or white; what has no colour is
grey. The degrees are those of `hue_deg` in a model, and the names those of its `colour`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from rich.table import Table

from bfsim.api import Colour
from bfsim.recording.images import load_image
from bfsim.recording.planes import YuvPlanes
from bfsim.report.tables import new_table, percent
from bfsim.terminal import print_report
from tinyphoon.stages.blob_detection import hues
from tinyphoon.stages.colour_reduction import HUES, colour_row
from tinyphoon.strategy.colour_names import COLOUR_NAMES, HUE_DEG, WITHOUT_HUE, colours_named
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.tables import arctangent_table
from tinyphoon.view.colours import colour_of

LONGEST_PX = 320
"""Larger pictures are scaled down: the kernel runs as plain Python here."""

NO_COLOUR: Colour = (128, 128, 128)


def as_seen(path: Path) -> tuple[Image.Image, NDArray[np.uint8]]:
    """Return a picture as it is looked at, of even width, and in UYVY."""
    picture = load_image(path).convert("RGB")
    picture.thumbnail((LONGEST_PX, LONGEST_PX))
    picture = picture.crop((0, 0, max(2, picture.width // 2 * 2), picture.height))
    return picture, YuvPlanes.from_image(picture).to_uyvy()


def reduced(uyvy: NDArray[np.uint8], limits: tuple[int, int, int]) -> NDArray[np.uint32]:
    """Return the colours of a picture, a bit a pixel, 0 for no colour."""
    atan = arctangent_table()
    words = np.zeros((uyvy.shape[0], uyvy.shape[1] // 2), np.uint32)
    for row, found in zip(uyvy, words, strict=True):
        colour_row(row, atan, found, *limits)
    return words


def drawn(words: NDArray[np.uint32]) -> Image.Image:
    """Return the picture of colours."""
    pixels = np.full((*words.shape, 3), NO_COLOUR, np.uint8)
    for word in np.unique(words[words != 0]).tolist():
        pixels[words == word] = colour_of(word)
    return Image.fromarray(pixels)


def rows(words: NDArray[np.uint32]) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, degrees, bit and share of the picture of every colour."""
    names = {colours_named(each): each for each in COLOUR_NAMES}
    for hue in range(HUES):
        word = hues(hue, hue)
        (name,) = (name for colours, name in names.items() if colours & word)
        degrees = f"{hue * HUE_DEG:.0f} to {(hue + 1) * HUE_DEG:.0f}"
        yield name, degrees, f"0x{word:08X}", percent(int((words == word).sum()), words.size)
    for name, word in (*WITHOUT_HUE.items(), ("no colour", 0)):
        yield name, "", f"0x{word:08X}", percent(int((words == word).sum()), words.size)


def table(words: NDArray[np.uint32]) -> Table:
    """Return the table of the colours of a picture."""
    made = new_table(
        "What the firmware calls the colours of the picture", "Colour", "degrees", "bit", "% of it"
    )
    for row in rows(words):
        made.add_row(*row)
    return made


@click.command()
@click.argument("picture", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--eps-black", default=INDOOR_FIELD.edges.eps_black, show_default=True)
@click.option("--eps-white", default=INDOOR_FIELD.edges.eps_white, show_default=True)
@click.option("--least-chroma", default=INDOOR_FIELD.edges.least_chroma, show_default=True)
def main(picture: Path, out: Path, eps_black: int, eps_white: int, least_chroma: int) -> None:
    """Keep PICTURE and its 32 colours side by side in OUT, and print the table of hues."""
    looked_at, uyvy = as_seen(picture)
    words = reduced(uyvy, (eps_black, eps_white, least_chroma))
    pair = Image.new("RGB", (2 * looked_at.width, looked_at.height))
    pair.paste(looked_at, (0, 0))
    pair.paste(drawn(words), (looked_at.width, 0))
    pair.save(out)
    print_report(table(words))


if __name__ == "__main__":
    main()
