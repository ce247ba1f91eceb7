"""SDRAM: which page each bank has open, and what that means for the next access.

Not modelled yet: refresh, tRAS and tWR, bus turn-round.
"""

from __future__ import annotations

from bfsim.chip.spec import SdramSpec


class Sdram:
    """State is the open page of each bank. Time is not known here; the EBIU asks and does the waiting."""

    def __init__(self, spec: SdramSpec) -> None:
        self._miss_sclk, self._conflict_sclk = spec.miss_sclk, spec.conflict_sclk
        self.open_pages: list[int] = [-1] * spec.banks
        """Page number that each bank has open, -1 when closed."""

    def open(self, pages: tuple[tuple[int, int, int], ...]) -> tuple[int, int]:
        """Open `pages` ((bank, page, words) each), one after the other; return (misses, conflicts).

        The first word of a page that was not open meets a miss or a conflict; every other word is a hit.
        """
        misses = conflicts = 0
        open_pages = self.open_pages
        for bank, page, _ in pages:
            before = open_pages[bank]
            if before != page:
                open_pages[bank] = page
                if before < 0:
                    misses += 1
                else:
                    conflicts += 1
        return misses, conflicts

    def extra_sclk(self, misses: int, conflicts: int) -> int:
        """Cycles that opening pages adds to a burst."""
        return misses * self._miss_sclk + conflicts * self._conflict_sclk
