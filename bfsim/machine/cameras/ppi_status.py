"""What a PPI notices about its camera and its DMA: frame tracking, and the sticky bits of PPI_STATUS.

Only for modes with external frame syncs: no field bit, and no preambles of ITU-R 656.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from bfsim.chip.ppi_registers import PpiStatusBit


class PpiStatus:
    """PPI_STATUS of one PPI, and the counters that are compared with PPI_COUNT and PPI_FRAME.

    Until the first frame sync, the PPI takes nothing. From then on it takes `frame_lines` lines per frame and
    `line_samples` samples per line, and ignores the rest. A frame that ends early sets FT_ERR, and the next one is
    counted from 0 again. The DMA goes on where it was, so its pictures are shifted from then on.
    """

    def __init__(self, name: str, frame_lines: int, line_samples: int) -> None:
        """`name` is PPI0 or PPI1, `frame_lines` the value of PPI_FRAME, `line_samples` PPI_COUNT + 1."""
        self._name = name
        self._frame_lines = frame_lines
        self._line_samples = line_samples
        self._lines = frame_lines
        self._causes: dict[PpiStatusBit, str] = {}

    @property
    def causes(self) -> Mapping[PpiStatusBit, str]:
        """Each set bit, with a sentence about what set it first. Any of them asserts the error interrupt."""
        return MappingProxyType(self._causes)

    def frame_sync(self) -> None:
        """Begin a frame. Sets FT_ERR if the previous one had too few lines."""
        if self._lines < self._frame_lines:
            self._set(
                PpiStatusBit.FT_ERR,
                f"a frame must have PPI_FRAME = {self._frame_lines} lines, not {self._lines}",
            )
        self._lines = 0

    def lines(self, number: int, samples: int) -> int:
        """Count `number` lines of so many `samples`, and return how many of all samples the PPI takes. Sets FT_ERR if a line has too few."""
        number = min(number, self._frame_lines - self._lines)
        if number and samples < self._line_samples:
            self._set(
                PpiStatusBit.FT_ERR,
                f"a line must have PPI_COUNT + 1 = {self._line_samples} samples, not {samples} (line {self._lines})",
            )
        self._lines += number
        return number * min(samples, self._line_samples)

    def overrun(self, lost_samples: int) -> None:
        """Set OVR: the FIFO was full and samples were lost, because the DMA did not get its bus in time."""
        self._set(
            PpiStatusBit.OVR,
            f"the FIFO must be emptied in time, but {lost_samples} samples found no room in it",
        )

    def read(self) -> int:
        """Return the register and clear it."""
        word = int(sum(self._causes))
        self._causes.clear()
        return word

    def _set(self, bit: PpiStatusBit, cause: str) -> None:
        """Set a bit. One that is already set keeps its cause."""
        self._causes.setdefault(bit, f"{self._name}_STATUS {bit.name}: {cause}")
