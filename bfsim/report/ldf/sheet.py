"""A sheet of rectangles and words: the drawing before it becomes a file of any format."""

from __future__ import annotations

from dataclasses import dataclass, field

FONT, SMALL_FONT, TITLE_FONT = 14, 12, 20

INK, FAINT, PAPER = "#1c2430", "#6b7585", "#ffffff"


@dataclass(frozen=True, slots=True, kw_only=True)
class FilledBox:
    """A filled rectangle; coordinates in px from the upper left corner."""

    x: float
    y: float
    width: float
    height: float
    fill: str
    outline: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Words:
    """One line of text; (x, y) is the middle of its left end or, with `is_right`, of its right end."""

    x: float
    y: float
    text: str
    font_px: int = FONT
    colour: str = INK
    is_right: bool = False


@dataclass(slots=True)
class Sheet:
    """A drawing that grows downwards."""

    width: float
    height: float = 0
    boxes: list[FilledBox] = field(default_factory=list)
    words: list[Words] = field(default_factory=list)
