"""A finding in a memory map, and how findings list names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

NAMES_LISTED = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing to look at: the `rule` that found it, `where`, why it matters and what to do about it."""

    rule: str
    where: str
    reason: str
    advice: str


def listed(names: Sequence[str]) -> str:
    """Return the names without duplicates; of many, the first few."""
    unique = list(dict.fromkeys(names))
    more = len(unique) - NAMES_LISTED
    if more > 0:
        return f"{', '.join(unique[:NAMES_LISTED])} and {more} more"
    return ", ".join(unique[:-1]) + " and " * (len(unique) > 1) + unique[-1]
