"""Which line of a kernel's new text is which line of its old one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher


@dataclass(frozen=True, slots=True)
class LinePair:
    """Places in the old and the new text, counted from 0; None where the text has no such line."""

    old: int | None
    new: int | None


def aligned(old: Sequence[str], new: Sequence[str]) -> Iterator[LinePair]:
    """Pair the lines of two texts, in their order: equal ones, then those that were rewritten one for one.

    Indentation is no difference.
    """
    matcher = SequenceMatcher(
        None, [each.strip() for each in old], [each.strip() for each in new], autojunk=False
    )
    for _, old_begin, old_end, new_begin, new_end in matcher.get_opcodes():
        for step in range(max(old_end - old_begin, new_end - new_begin)):
            yield LinePair(
                old_begin + step if old_begin + step < old_end else None,
                new_begin + step if new_begin + step < new_end else None,
            )
