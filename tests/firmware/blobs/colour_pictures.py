"""Pictures of colours that a segmentation may get wrong: many labels that meet late, in all corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint32]

RED, PINK, BLUE, OTHER = 1 << 5, 1 << 6, 1 << 20, 1 << 30
GROUPS = (RED | PINK, BLUE)
"""Two groups, one of two colours; OTHER is of no interest."""


def words_of(drawing: str) -> Words:
    """Return a drawing of r, p, b, o and dots as a picture."""
    colours = {".": 0, "r": RED, "p": PINK, "b": BLUE, "o": OTHER}
    return np.array([[colours[each] for each in line] for line in drawing.split()], np.uint32)


def comb(teeth: int, height: int) -> Words:
    """Teeth one pixel wide that only meet in the last row: a label each, all one segment."""
    picture = np.zeros((height, 2 * teeth - 1), np.uint32)
    picture[:, ::2] = RED
    picture[-1] = PINK
    return picture


def spiral(size: int) -> Words:
    """An arm one pixel wide, with gaps one pixel wide, that winds inwards clockwise from the top left corner."""
    picture = np.zeros((size, size), np.uint32)
    y, x, dy, dx = 0, 0, 0, 1
    turns = 0
    while turns < 2:
        picture[y, x] = BLUE
        ahead, beyond = (y + dy, x + dx), (y + 2 * dy, x + 2 * dx)
        if _is_free(picture, *ahead, outside=False) and _is_free(picture, *beyond, outside=True):
            (y, x), turns = ahead, 0
        else:
            dy, dx, turns = dx, -dy, turns + 1
    return picture


def _is_free(picture: Words, y: int, x: int, *, outside: bool) -> bool:
    height, width = picture.shape
    return not picture[y, x] if 0 <= y < height and 0 <= x < width else outside


def checkerboard(height: int, width: int, first: int, second: int, square: int = 1) -> Words:
    """Squares of two colours by turns."""
    y, x = np.indices((height, width)) // square
    return np.where((y + x) % 2 == 0, first, second).astype(np.uint32)


def dots(height: int, width: int) -> Words:
    """Single pixels that touch nothing, in every second column of every second row."""
    picture = np.zeros((height, width), np.uint32)
    picture[::2, ::2] = RED
    return picture


def scattered(height: int, width: int, seed: int, square: int = 1) -> Words:
    """Squares of colour by chance, about half of them empty."""
    rng = np.random.default_rng(seed)
    squares = rng.choice(
        np.array([0, 0, 0, RED, PINK, BLUE, OTHER], np.uint32), (height // square + 1, width // square + 1)
    )
    return squares.repeat(square, axis=0).repeat(square, axis=1)[:height, :width].copy()


HARD_PICTURES = {
    "all black": np.zeros((7, 9), np.uint32),
    "one colour": np.full((9, 7), PINK, np.uint32),
    "nothing of interest": np.full((5, 6), OTHER, np.uint32),
    "one pixel": words_of("r"),
    "one column": np.array([[RED], [PINK], [0], [BLUE], [RED], [OTHER], [RED]], np.uint32),
    "one row": words_of("rrp.bbrbooprr.r"),
    "two groups by turns": checkerboard(10, 13, RED, BLUE),
    "a group and none by turns": checkerboard(13, 10, PINK, 0),
    "a group of two colours by turns": checkerboard(8, 8, RED, PINK),
    "stripes": words_of("r.b.r.b.r r.b.r.b.r r.b.r.b.r"),
    "comb": comb(40, 6),
    "comb upside down": comb(40, 6)[::-1].copy(),
    "two combs in each other": np.vstack([comb(30, 5), comb(30, 5)[::-1]]),
    "spiral": spiral(41),
    "spiral of the other hand": spiral(40)[:, ::-1].copy(),
    "spiral upside down": spiral(39)[::-1].copy(),
    "dots": dots(13, 31),
    "corners only": words_of("r...r .r.r. ..r.. .r.r. r...r"),
    "crossing diagonals": words_of("r..b .rb. .br. b..r"),
    "slope to the left": words_of("......rr ....rr.. ..rr.... rr......"),
    "V and W": words_of("r...r...r .r.r.r.r. ..r...r.."),
    "ends of the rows": words_of("r....r .....r r..... ....rr rr...."),
    "ring in a ring": words_of("rrrrrrr r.....r r.bbb.r r.b.b.r r.bbb.r r.....r rrrrrrr"),
    "chance": scattered(21, 27, seed=1),
    "chance in squares": scattered(60, 50, seed=2, square=3),
}
