"""Bars of characters: what of some cycles is work, stalls and idling, in parts of a whole."""

from __future__ import annotations

from rich.text import Text

from bfsim.report.budget.waits import Cycles

WORK, STALL, IDLE = ("█", "cyan"), ("▓", "red"), ("░", "bright_black")
"""How they are drawn, and in which colour where there are colours."""


def bar_of(cost: Cycles, whole_cclk: int, length: int) -> Text:
    """Return a bar of which `length` characters stand for the whole; what is less than half of one is not drawn."""
    parts = (cost.issue_cclk, *WORK), (sum(cost.stall_cclk.values()), *STALL), (cost.idle_cclk, *IDLE)
    text, cclk = Text(), 0
    for part, sign, style in parts:
        cclk += part
        text.append(sign * (round(length * cclk / whole_cclk) - len(text)) if whole_cclk else "", style)
    return text
