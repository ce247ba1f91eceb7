"""Bars of characters: work, stalls and idling as parts of a whole."""

from __future__ import annotations

from rich.text import Text

from bfsim.report.budget.waits import Cycles

WORK, STALL, IDLE = ("█", "cyan"), ("▓", "red"), ("░", "bright_black")
"""How they are drawn, and their colours, if the terminal has any."""


def bar_of(cost: Cycles, whole_cclk: int, length: int) -> Text:
    """Return a bar in which `length` characters stand for the whole; less than half a character is not drawn."""
    parts = (cost.issue_cclk, *WORK), (sum(cost.stall_cclk.values()), *STALL), (cost.idle_cclk, *IDLE)
    text, cclk = Text(), 0
    for part, sign, style in parts:
        cclk += part
        text.append(sign * (round(length * cclk / whole_cclk) - len(text)) if whole_cclk else "", style)
    return text
