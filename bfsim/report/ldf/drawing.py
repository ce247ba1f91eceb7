"""The memory map as rectangles and words on a sheet, which `picture` writes as PNG or SVG.

Each segment is a panel: a bar to its own scale, names where they fit, and below it a legend of its content. Panels of
core A stand on the left, those of core B on the right, shared memories below both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from bfsim.report.ldf.colours import colours_of, kind_colour
from bfsim.report.ldf.map import SHARED, ContentKind, MapPiece, MapSegment, MemoryMap
from bfsim.report.ldf.sheet import FAINT, FONT, INK, PAPER, SMALL_FONT, TITLE_FONT, FilledBox, Sheet, Words
from bfsim.report.wording.units import size

# lengths in px
MARGIN, GUTTER = 24, 32
PANEL_WIDTH = 640
BAR_HEIGHT, TITLE_HEIGHT, LINE_HEIGHT, PANEL_GAP = 44, 24, 20, 22

LETTER_WIDTH = 0.6  # of the font's size: the widest sans-serif digits
SWATCH = 12
MOST_LEGEND_COLUMNS = 3
SEAM_WIDTH = 4  # between pieces that are wide enough for a seam

KINDS = {
    ContentKind.CODE: "code",
    ContentKind.CAMERA: "filled by a camera",
    ContentKind.LINES: "images and rings",
    ContentKind.ROW: "rows",
    ContentKind.TABLE: "tables",
}
"""The meanings of the hues."""

FREE_COLOUR, RESERVED_COLOUR = "#eef1f5", "#c3cad6"


def drawing_of(memory_map: MemoryMap) -> Sheet:
    """Return the drawing of every segment of a map."""
    sheet = Sheet(width=2 * MARGIN + 2 * PANEL_WIDTH + GUTTER)
    pen = _Pen(sheet, colours_of(memory_map))
    pen.heading(memory_map)
    owners = sorted({each.owner for each in memory_map.segments} - {SHARED})
    columns = [[each for each in memory_map.segments if each.owner == owner] for owner in owners]
    shared = [each for each in memory_map.segments if each.owner == SHARED]
    pen.columns(columns)
    for _, group in groupby(shared, key=lambda each: each.memory):
        alike = list(group)
        pen.columns([alike[::2], alike[1::2]])
    sheet.height += MARGIN
    return sheet


@dataclass(slots=True)
class _Pen:
    """Draws panels onto a sheet."""

    sheet: Sheet
    colours: dict[str, str]

    def heading(self, memory_map: MemoryMap) -> None:
        """Draw the title of the map, and the meanings of its hues and greys."""
        y = MARGIN + TITLE_FONT / 2
        what = f" with {memory_map.firmware} at {memory_map.width_px}x{memory_map.height_px}"
        title = f"{memory_map.ldf} on {memory_map.board}{what if memory_map.firmware else ''}"
        self._write(MARGIN, y, title, font_px=TITLE_FONT)
        y += 30
        x: float = MARGIN
        kinds = [(kind_colour(kind), name) for kind, name in KINDS.items()]
        for fill, name in (*kinds, (FREE_COLOUR, "free"), (RESERVED_COLOUR, "reserved, or a gap")):
            x = self._entry(x, y, fill, name)
        caches = ", ".join(f"{size(each.nbytes)} of {each.memory}" for each in memory_map.caches)
        if caches:
            y += LINE_HEIGHT
            self._write(MARGIN, y, f"cache: {caches}", colour=FAINT)
        self.sheet.height = y + LINE_HEIGHT + PANEL_GAP / 2

    def columns(self, columns: Sequence[Sequence[MapSegment]]) -> None:
        """Draw the segments of each list below each other, and the lists side by side."""
        top = bottom = self.sheet.height
        for number, segments in enumerate(columns):
            y = top
            for segment in segments:
                y = self.panel(MARGIN + (number % 2) * (PANEL_WIDTH + GUTTER), y, segment)
            bottom = max(bottom, y)
        self.sheet.height = bottom

    def panel(self, x: float, y: float, segment: MapSegment) -> float:
        """Draw one segment; return where the next one can begin."""
        use = f"{size(segment.used_bytes)} used, {size(segment.free_bytes)} free of {size(segment.nbytes)}"
        self._write(x, y + TITLE_HEIGHT / 2, segment.name)
        self._write(x + PANEL_WIDTH, y + TITLE_HEIGHT / 2, use, colour=FAINT, is_right=True)
        y += TITLE_HEIGHT
        self._bar(x, y, segment)
        y += BAR_HEIGHT + LINE_HEIGHT / 2
        end = f"0x{segment.start + segment.nbytes - 1:08X}"
        self._write(x, y, f"0x{segment.start:08X}", font_px=SMALL_FONT, colour=FAINT)
        self._write(x + PANEL_WIDTH, y, end, font_px=SMALL_FONT, colour=FAINT, is_right=True)
        y += LINE_HEIGHT
        entries = [
            (self._fill(each), f"{segment.label(each)}  {size(each.nbytes)}")
            for each in segment.pieces
            if each.is_named
        ]
        columns = _columns([label for _, label in entries])
        for number, (fill, label) in enumerate(entries):
            line, column = divmod(number, columns)
            self._entry(x + column * PANEL_WIDTH / columns, y + line * LINE_HEIGHT, fill, label)
        return y + -(-len(entries) // columns) * LINE_HEIGHT + PANEL_GAP

    def _bar(self, x: float, y: float, segment: MapSegment) -> None:
        scale = PANEL_WIDTH / segment.nbytes
        for piece in segment.pieces:
            left, width = x + (piece.start - segment.start) * scale, piece.nbytes * scale
            # a seam separates neighbours of one kind
            seam = PAPER if piece.is_named and width > SEAM_WIDTH else ""
            self._box(left, y, width, BAR_HEIGHT, self._fill(piece), seam)
            if piece.is_named and _width(segment.label(piece), SMALL_FONT) < width - 6:
                middle = y + BAR_HEIGHT / 2
                self._write(left + 3, middle - 8, segment.label(piece), font_px=SMALL_FONT)
                self._write(left + 3, middle + 8, size(piece.nbytes), font_px=SMALL_FONT)
        self.sheet.boxes.append(
            FilledBox(x=x, y=y, width=PANEL_WIDTH, height=BAR_HEIGHT, fill="", outline=FAINT)
        )

    def _entry(self, x: float, y: float, fill: str, label: str) -> float:
        """Draw a line of a legend; return where the next one can begin."""
        self._box(x, y - SWATCH / 2, SWATCH, SWATCH, fill, FAINT)
        self._write(x + SWATCH + 6, y, label, font_px=SMALL_FONT)
        return x + SWATCH + 6 + _width(label, SMALL_FONT) + 24

    def _fill(self, piece: MapPiece) -> str:
        if piece.kind is ContentKind.FREE:
            return FREE_COLOUR
        return RESERVED_COLOUR if piece.kind is ContentKind.RESERVED else self.colours[piece.name]

    def _box(self, x: float, y: float, width: float, height: float, fill: str, outline: str = "") -> None:
        self.sheet.boxes.append(FilledBox(x=x, y=y, width=width, height=height, fill=fill, outline=outline))

    def _write(
        self, x: float, y: float, text: str, *, font_px: int = FONT, colour: str = INK, is_right: bool = False
    ) -> None:
        self.sheet.words.append(Words(x=x, y=y, text=text, font_px=font_px, colour=colour, is_right=is_right))


def _columns(labels: Sequence[str]) -> int:
    """Return how many columns a legend may have without overlapping labels."""
    widest = SWATCH + 6 + max((_width(each, SMALL_FONT) for each in labels), default=0) + 6
    return max(1, min(MOST_LEGEND_COLUMNS, int(PANEL_WIDTH // widest)))


def _width(text: str, font_px: int) -> float:
    return len(text) * font_px * LETTER_WIDTH
