"""Open & closing as T §6.6 accounts for it: the words of the colour image are read where they are, in SDRAM.

[said] The time of the stage is that of its SDRAM accesses (T §6.6). [implied] So they wait for the core: no DMA brings these lines.
[assumed] Each pixel's three words, one above the other, are read once; the eroded lines stay in L1, and DMA takes the opened ones
back.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame
from tinyphoon.scan_lines import line_ring, windows
from tinyphoon.stages.fast_opening import dilate_columns, erode_columns
from tinyphoon.stages.open_closing import NoiseRemoval, repeat_border


def sdram_opening(core: Core, frame: Frame, noise: NoiseRemoval) -> Generator[Any, Any, None]:
    """Leave the colour image without its noise in `opened_image` in SDRAM, the same as `open_closing`."""
    for image, closes in noise.passes:
        first, second = (dilate_columns, erode_columns) if closes else (erode_columns, dilate_columns)
        height = frame.height
        opened = core.output_ring("opened_ring", core.rows("opened_image"))
        between = line_ring(core.rows("eroded_ring"), height)
        near_colours, near = windows(core.rows(image)), windows(between)
        for y in range(height + 1):
            if y < height:
                core.at(y)
                yield core.run(first, *near_colours[y], between[y])
                if closes:
                    yield core.run(repeat_border, between[y])
            if y >= 1:
                core.at(y - 1)
                row = yield from opened.row()
                yield core.run(second, *near[y - 1], row)
                opened.send()
        core.at()
        yield from opened.flush()
