"""All that firmware needs, and the only module of bfsim that it imports."""

from __future__ import annotations

from bfsim.chip.dma_registers import Flow, WdSize
from bfsim.chip.ppi_registers import PpiStatusBit
from bfsim.compiling.kernel_from import kernel_from
from bfsim.errors import FirmwareError, cut, shown
from bfsim.kernel import Kernel, Work, f32, i8, i16, i32, kernel, quotient, remainder, sqrt, u8, u16, u32
from bfsim.machine.cameras.settling import CameraSettings
from bfsim.machine.core.core import Core, Frame
from bfsim.machine.core.readout import Readout
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.descriptors import write_descriptor
from bfsim.machine.dma.memory_dma import MemoryDma
from bfsim.machine.dma.ring import InputRing, OutputRing
from bfsim.machine.memories import Row
from bfsim.machine.program import Buffer, Buffers, Calibration, Firmware, FrameSize, Geometry, SourcePixels
from bfsim.machine.spi.device import Script, SpiDevice, SpiMessage
from bfsim.seen import (
    Colour,
    NamedColour,
    PictureColours,
    Seen,
    SeenArrow,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenLoss,
    SeenMap,
    SeenObject,
    SeenRectangle,
    SeenText,
    Solid,
    no_edges_3d,
)
from bfsim.trace import BudgetRow, Reference

__all__ = [
    "BudgetRow", "Buffer", "Buffers", "Calibration", "CameraSettings", "Colour", "Core", "DmaConfig", "Firmware", "FirmwareError", "Flow", "Frame",
    "FrameSize", "Geometry", "InputRing", "Kernel", "MemoryDma", "NamedColour", "OutputRing", "PictureColours", "PpiStatusBit", "Readout", "Reference", "Row", "Script", "Seen", "SeenArrow", "SeenBlob",
    "SeenCircle", "SeenEdges", "SeenEdges3D", "SeenGeometry", "SeenLine", "SeenLine3D", "SeenLoss", "SeenMap", "SeenObject", "SeenRectangle", "SeenText", "Solid", "SourcePixels",
    "SpiDevice", "SpiMessage", "WdSize", "Work", "cut", "f32", "i8", "i16", "i32", "kernel", "kernel_from", "no_edges_3d", "quotient", "remainder", "shown", "sqrt", "u8", "u16", "u32", "write_descriptor",
]  # fmt: skip
