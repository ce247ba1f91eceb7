"""The memory map as text: a bar to scale for each segment, and a key to its letters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from string import ascii_letters

from rich.console import Group
from rich.style import Style
from rich.text import Text

from bfsim.report.ldf.colours import colours_of
from bfsim.report.ldf.map import ContentKind, MapPiece, MapSegment, MemoryMap
from bfsim.report.wording.units import size

CELLS = 64
LEGEND_COLUMNS = 80
FREE, RESERVED, MANY = "·", "░", "*"


def bars(memory_map: MemoryMap) -> Group:
    """Return the bars of all segments that hold a symbol."""
    colours = colours_of(memory_map)
    title = Text(f"Picture, each segment to its own scale: {FREE} free, {RESERVED} reserved", style="bold")
    shown = [each for each in memory_map.segments if each.symbols]
    return Group(title, *(line for each in shown for line in _segment(each, colours)))


def _segment(segment: MapSegment, colours: dict[str, str]) -> Iterator[Text]:
    letters = dict(zip(_named(segment), _letters(), strict=False))
    yield Text(f"{segment.name}, 1 cell = {size(-(-segment.nbytes // CELLS))}")
    bar = Text("  ")
    for piece in cells_of(segment, CELLS):
        bar.append(_sign(piece, letters), _style(piece, colours))
    yield bar
    legend = Text("  ")
    for piece, letter in letters.items():
        entry = f"{letter} {segment.label(piece)} {size(piece.nbytes)}"
        if len(legend) + len(entry) > LEGEND_COLUMNS:
            yield legend
            legend = Text("  ")
        legend.append(letter, _style(piece, colours)).append(f"{entry[1:]}  ")
    yield legend


def cells_of(segment: MapSegment, cells: int) -> Iterator[MapPiece]:
    """Yield the piece that fills most of each of `cells` equal parts; symbols win over reserves and free space."""
    for number in range(cells):
        start = segment.start + segment.nbytes * number // cells
        end = segment.start + segment.nbytes * (number + 1) // cells
        yield max(
            segment.pieces,
            key=lambda piece: (
                _overlap(piece, start, end) > 0 and piece.is_named,
                _overlap(piece, start, end),
            ),
        )


def _overlap(piece: MapPiece, start: int, end: int) -> int:
    return max(0, min(piece.start + piece.nbytes, end) - max(piece.start, start))


def _named(segment: MapSegment) -> Sequence[MapPiece]:
    return [each for each in segment.pieces if each.is_named]


def _letters() -> Iterator[str]:
    yield from ascii_letters
    while True:
        yield MANY


def _sign(piece: MapPiece, letters: dict[MapPiece, str]) -> str:
    if piece.kind is ContentKind.FREE:
        return FREE
    return letters.get(piece, RESERVED)


def _style(piece: MapPiece, colours: dict[str, str]) -> Style:
    return Style(color=colours[piece.name]) if piece.is_named else Style(dim=True)
