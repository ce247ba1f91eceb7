"""All that firmware needs, and the only module of bfsim that it imports."""

from __future__ import annotations

from bfsim.errors import FirmwareError
from bfsim.kernel import Kernel, Work, f32, i8, i16, i32, kernel, sqrt, u8, u16, u32
from bfsim.machine.core import Core, Frame
from bfsim.machine.memories import Row
from bfsim.machine.program import Buffer, Buffers, Firmware, FrameSize, SourcePixels
from bfsim.machine.ring import InputRing, OutputRing
from bfsim.trace import BudgetRow

__all__ = [
    "BudgetRow", "Buffer", "Buffers", "Core", "Firmware", "FirmwareError", "Frame", "FrameSize", "InputRing", "Kernel",
    "OutputRing", "Row", "SourcePixels", "Work", "f32", "i8", "i16", "i32", "kernel", "sqrt", "u8", "u16", "u32",
]  # fmt: skip
