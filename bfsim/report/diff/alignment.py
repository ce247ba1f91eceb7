"""Which lines of a kernel's old and new text correspond."""

from __future__ import annotations

import re
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

NAMES = re.compile(r"\w+|[^\w\s]+")
ANY = 0.01
"""The weight of a pair of lines with nothing in common, where a pair of equal lines weighs 1."""


@dataclass(frozen=True, slots=True)
class LinePair:
    """Positions in the old and the new text, counted from 0; None if the text has no such line."""

    old: int | None
    new: int | None


def with_moved(pairs: Iterable[LinePair], old: Sequence[str], new: Sequence[str]) -> Iterator[LinePair]:
    """Yield pairs of `aligned`, but pair lines that vanished in one place and stand unchanged in another."""
    pairs = list(pairs)
    gone: defaultdict[str, deque[int]] = defaultdict(deque)
    for each in pairs:
        if each.old is not None and each.new is None:
            gone[old[each.old].strip()].append(each.old)
    moved = {
        each.new: there.popleft()
        for each in pairs
        if each.old is None and each.new is not None and (there := gone[new[each.new].strip()])
    }
    for each in pairs:
        if each.new in moved:
            yield LinePair(moved[each.new], each.new)
        elif each.new is not None or each.old not in moved.values():
            yield each


def aligned(old: Sequence[str], new: Sequence[str]) -> Iterator[LinePair]:
    """Pair the lines of two texts, in order: equal ones, and among rewritten ones the most similar.

    Indentation is no difference.
    """
    matcher = SequenceMatcher(
        None, [each.strip() for each in old], [each.strip() for each in new], autojunk=False
    )
    for tag, old_begin, old_end, new_begin, new_end in matcher.get_opcodes():
        if tag == "equal":
            pairs = list(zip(range(old_begin, old_end), range(new_begin, new_end), strict=True))
        else:
            alike = _alike(old[old_begin:old_end], new[new_begin:new_end])
            pairs = [(old_begin + one, new_begin + other) for one, other in alike]
        old_at, new_at = old_begin, new_begin
        for one, other in [*pairs, (old_end, new_end)]:
            yield from (LinePair(place, None) for place in range(old_at, one))
            yield from (LinePair(None, place) for place in range(new_at, other))
            if one < old_end:
                yield LinePair(one, other)
            old_at, new_at = one + 1, other + 1


def _alike(old: Sequence[str], new: Sequence[str]) -> list[tuple[int, int]]:
    """Return as many pairs as possible, in order, that are most similar in all."""
    best = [[0.0] * (len(new) + 1) for _ in range(len(old) + 1)]
    words = [set(NAMES.findall(each)) for each in old], [set(NAMES.findall(each)) for each in new]
    scores = [[ANY + len(one & other) / (len(one | other) or 1) for other in words[1]] for one in words[0]]
    for i in reversed(range(len(old))):
        for j in reversed(range(len(new))):
            best[i][j] = max(best[i + 1][j], best[i][j + 1], best[i + 1][j + 1] + scores[i][j])
    pairs, i, j = list[tuple[int, int]](), 0, 0
    while i < len(old) and j < len(new):
        if best[i][j] == best[i + 1][j + 1] + scores[i][j]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif best[i][j] == best[i + 1][j]:
            i += 1
        else:
            j += 1
    return pairs
