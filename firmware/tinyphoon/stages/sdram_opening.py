"""Open & closing as T §6.6 accounts for it: the words of the colour image are read where they are, in SDRAM.

[said] The time of the stage is that of its SDRAM accesses (T §6.6). [implied] So they wait for the core: no DMA brings these lines.
[assumed] Each pixel's three words, one above the other, are read once; the eroded lines stay in L1, and DMA takes the opened ones
back.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame
from tinyphoon.scan_lines import line_ring, window
from tinyphoon.stages.fast_opening import dilate_columns, erode_columns


def sdram_opening(core: Core, frame: Frame) -> Generator[Any, Any, None]:
    """Open the colour image; leaves `opened_image` in SDRAM, the same as `open_closing` does."""
    colours, height = core.rows("colour_image"), frame.height
    opened = core.output_ring("opened_ring", core.rows("opened_image"))
    eroded = line_ring(core.rows("eroded_ring"), height)
    for y in range(height + 1):
        if y < height:
            core.at(y)
            yield core.run(erode_columns, *window(colours, y, height), eroded[y])
        if y >= 1:
            core.at(y - 1)
            row = yield from opened.row()
            yield core.run(dilate_columns, *window(eroded, y - 1, height), row)
            opened.send()
    core.at()
    yield from opened.flush()
