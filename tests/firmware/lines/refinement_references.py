"""Where the refined lines must be, in plain Python on a grey picture; shares no code with the firmware's kernels.

Whole numbers where the firmware has them, rounded as there: places in 1/16 px, offsets in 1/128, slopes in 1/4096.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tests.firmware.lines.line_references import border, spread
from tests.firmware.references import angle

Words = Sequence[int]


def offsets(line: Words, picture: np.ndarray, reach: int, min_step: int) -> list[tuple[int, int]]:
    """For each row where the line's edge is seen: how far right of the line, and the row counted from the middle one."""
    x0, y0, x1, y1, *_ = line
    width = picture.shape[1]
    side = 1 if y1 > y0 else -1
    slope = 4096 * (x1 - x0) // (y1 - y0)
    top, bottom = min(y0, y1), max(y0, y1)
    found = []
    for row in range(-(-top // 16) + 2, bottom // 16 - 2 + 1):
        column = x0 + slope * (16 * row - y0) // 4096
        centre = (column + 8) // 16
        steps = {
            x: side * (int(picture[row, x + 1]) - int(picture[row, x - 1]))
            for x in range(max(centre - reach, 1), min(centre + reach, width - 2) + 1)
            if 0 <= row < len(picture)
        }
        weights = {x: step for x, step in steps.items() if step >= min_step}
        if weights:
            total = sum(weights.values())
            moment = sum(step * (16 * x - column) for x, step in weights.items())
            found.append(((8 * moment + total // 2) // total, row - (top + bottom) // 32))
    return found


def refined(
    lines: Sequence[Words], picture: np.ndarray, reach: int, min_step: int
) -> tuple[list[list[int]], int]:
    """The lines after the refinement, and how many were moved."""
    result, count = [], 0
    for line in lines:
        moves = _moves(line, picture, reach, min_step)
        if moves is None:
            result.append(list(line))
            continue
        size = picture.shape[1], picture.shape[0]
        x0, y0, x1, y1 = line[0] + moves[0], line[1], line[2] + moves[1], line[3]
        muff = border(x0, y0, x0 - x1, y0 - y1, size), border(x1, y1, x1 - x0, y1 - y0, size)
        result.append(
            [x0, y0, x1, y1, angle(np.array(x1 - x0), np.array(y1 - y0)).item(), line[5], line[6], *muff]
        )
        count += 1
    return result, count


def _moves(line: Words, picture: np.ndarray, reach: int, min_step: int) -> tuple[int, int] | None:
    """How far both ends go to the right; None for a line that stays."""
    x0, y0, x1, y1, *_ = line
    if reach == 0 or y0 == y1 or abs(x1 - x0) > abs(y1 - y0):
        return None
    points = offsets(line, picture, reach, min_step)
    looked_at = (max(y0, y1) // 16 - 2) - (-(-min(y0, y1) // 16) + 2)
    if len(points) < 4 or 2 * len(points) <= looked_at:
        return None
    off, down = zip(*points, strict=True)
    run, rise = spread(down, down), spread(off, down)
    while run >= 2**18 or abs(rise) >= 2**18:
        run, rise = run // 2, rise // 2
    turn = 4096 * rise // run
    middle = 16 * ((min(y0, y1) + max(y0, y1)) // 32) + 16 * sum(down) // len(down)
    moves = []
    for y in (y0, y1):
        sixteenths = 16 * sum(off) // len(off) + turn * (y - middle) // 4096
        moves.append((sixteenths + 64) // 128)
    return (moves[0], moves[1]) if max(map(abs, moves)) <= 24 else None
