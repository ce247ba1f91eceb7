"""The buffers of the firmware and their places: line rings and the edge store in L1, pictures in SDRAM.

Each core's camera and each core's working images have an SDRAM bank of their own. For pictures of w x h pixels, L1 bank
A holds 46 w bytes and bank B 19 w + 6 h + 6 KB: 640x480 fits, beside heap and stack.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from bfsim.api import Buffer, Buffers, Calibration, FrameSize, u8, u16, u32
from tinyphoon.exchange import exchange_buffers
from tinyphoon.geometry import check_thesis_geometry, geometry_buffer, thesis_geometry_buffer
from tinyphoon.stages.blob_detection import blob_buffers
from tinyphoon.stages.circle_detection import circle_buffers
from tinyphoon.stages.colour_reduction import colour_buffers
from tinyphoon.stages.edge_detection import scan_buffers
from tinyphoon.stages.edge_thinning import thinning_buffers
from tinyphoon.stages.hysteresis import hysteresis_buffers
from tinyphoon.stages.line_detection import line_buffers
from tinyphoon.stages.object_detection import (
    left_object_buffers,
    object_buffers,
    shared_object_buffers,
)
from tinyphoon.stages.rectangle_detection import rectangle_buffers
from tinyphoon.stages.rectification import rectification_buffers
from tinyphoon.stages.stereo_edges import stereo_edge_buffers
from tinyphoon.stages.stereo_lines import stereo_line_buffers
from tinyphoon.stores.edges import EDGE_CAPACITY
from tinyphoon.strategy.models import model_buffers
from tinyphoon.strategy.orders import order_buffers, shared_order_buffers
from tinyphoon.strategy.results import MESSAGE_WORDS
from tinyphoon.tables import arctangent_table

ScanBuffers = Callable[[FrameSize], Sequence[Buffer]]
"""The buffers that a scan of a picture needs between its kernels."""

CAMERA_FRAMES = 3  # one in work, one waiting, one being filled


def buffers(size: FrameSize, scan_buffers: ScanBuffers = scan_buffers) -> Mapping[str, Sequence[Buffer]]:
    """Return the buffers of each core for pictures of `size`; `scan_buffers`: those of a scan."""
    return {
        "A": (
            *_left_buffers(size, scan_buffers),
            *stereo_line_buffers(),
            *stereo_edge_buffers("sdram_bank2"),
        ),
        "B": _core_buffers(size, scan_buffers, camera="sdram_bank1", images="sdram_bank3"),
        "shared": (
            *exchange_buffers(size),
            *shared_object_buffers(),
            *shared_order_buffers(size, "l2_shared"),
        ),
    }


def one_core_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """Return the buffers of a board with one core for pictures of `size`."""
    return {"A": (*_left_buffers(size, scan_buffers), *shared_order_buffers(size, "data1"))}


def calibration_buffers(calibration: Calibration) -> Buffers:
    """Return the buffers that depend on a recording's cameras: tables if it has them, and the geometry."""
    return with_geometry(rectification_buffers(calibration.sources), calibration)


def with_geometry(tables: Buffers, calibration: Calibration) -> Buffers:
    """Return the tables of each core and the geometry of a recording.

    Raises FirmwareError if there is none, and the pictures are too large for the thesis's.
    """
    if calibration.size and not calibration.geometries:
        check_thesis_geometry(calibration.size)
    geometry = tuple(geometry_buffer(each) for each in calibration.geometries)
    return {core: (*tables.get(core, ()), *geometry) for core in ("A", "B")}


def _left_buffers(size: FrameSize, scan_buffers: ScanBuffers) -> Sequence[Buffer]:
    return (
        *_core_buffers(size, scan_buffers, camera="sdram_bank0", images="sdram_bank2"),
        *left_object_buffers(),
        Buffer("edge_data", u32, EDGE_CAPACITY, "bsz"),
        Buffer("results", u16, MESSAGE_WORDS, "data1"),
    )


def _core_buffers(
    size: FrameSize, scan_buffers: ScanBuffers, *, camera: str, images: str
) -> Sequence[Buffer]:
    width, height = size.width_px, size.height_px
    return (
        Buffer("camera", u8, 2 * width, camera, rows=CAMERA_FRAMES * height),
        Buffer("colour_image", u32, width, images, rows=height),
        Buffer("edge_image", u8, width, images, rows=height),
        Buffer("opened_image", u32, width, images, rows=height),
        # rings of DMA lines: one row more than the stage uses at a time
        Buffer("camera_ring", u8, 2 * width, "L1_data_a", rows=2),
        Buffer("colour_ring", u32, width, "L1_data_a", rows=4),
        Buffer("opened_ring", u32, width, "L1_data_a", rows=2),
        Buffer("edge_ring", u8, width, "L1_data_b", rows=2),
        # rings between kernels
        *scan_buffers(size),
        Buffer("eroded_ring", u32, width, "L1_data_a", rows=3),
        thesis_geometry_buffer(size),
        Buffer("atan", u8, 257, "L1_data_b", values=arctangent_table()),
        *colour_buffers(),
        *thinning_buffers(size, images),
        Buffer("edge_index", u32, height, "L1_data_b"),
        Buffer("edge_counts", u16, height, "L1_data_b"),
        *hysteresis_buffers(),
        *blob_buffers(size),
        *line_buffers(size),
        *circle_buffers(),
        *rectangle_buffers(),
        *object_buffers(),
        *order_buffers(),
        *model_buffers(),
    )
