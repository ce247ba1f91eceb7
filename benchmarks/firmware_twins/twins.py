"""The kernels that have a C twin, and what a compiler profile says that their recorded calls cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.firmware_twins.recorded import Calls, copied, recorded
from benchmarks.twins.lcg import fnv
from bfsim.api import Kernel
from bfsim.kernel import CompilerProfile
from bfsim.machine_code import Effort
from bfsim.verifying.player import checksum
from tinyphoon.stages.blob_detection import segment_row
from tinyphoon.stages.circle_consensus import agree_on_side
from tinyphoon.stages.circle_edges import select_edges_row
from tinyphoon.stages.circle_fit import fit_circle
from tinyphoon.stages.circle_judging import judge_consensus
from tinyphoon.stages.circle_outline import refine_row
from tinyphoon.stages.circle_votes import draw_lines
from tinyphoon.stages.colour_reduction import colour_row
from tinyphoon.stages.edge_correspondence import match_edges
from tinyphoon.stages.edge_depths import store_edges3d_row
from tinyphoon.stages.edge_detection import (
    direction_row,
    gauss3_row,
    grey_row,
    magnitude_row,
    sobel_row,
    suppress_row,
)
from tinyphoon.stages.edge_rows import spread_left_row, spread_right_row, take_left_row, take_right_row
from tinyphoon.stages.edge_storing import store_edges_row
from tinyphoon.stages.hysteresis import group_edges_row, keep_edges_row, label_edges_row
from tinyphoon.stages.line_connectors import connect_far, connect_near
from tinyphoon.stages.line_detection import fit_lines
from tinyphoon.stages.line_refinement import look_at_row
from tinyphoon.stages.line_scan import segments_row
from tinyphoon.stages.open_closing import dilate_row, erode_row

TWINS: tuple[Kernel, ...] = (
    grey_row, colour_row, gauss3_row, sobel_row, magnitude_row, direction_row, suppress_row, store_edges_row,
    group_edges_row, label_edges_row, keep_edges_row, erode_row, dilate_row, segment_row, segments_row,
    connect_near, fit_lines, connect_far, look_at_row, select_edges_row, draw_lines, refine_row, fit_circle,
    agree_on_side, judge_consensus,
    take_left_row, take_right_row, spread_left_row, spread_right_row, match_edges, store_edges3d_row,
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Predicted:
    """What a profile says of a kernel's recorded calls: cycles of each, and the checksum of what they leave."""

    cycles: tuple[int, ...]
    checksum: str


def predict(kernel: Kernel, calls: Calls, profile: CompilerProfile) -> Predicted:
    """Make the recorded calls of a kernel."""
    code = kernel.compile(profile, effort=Effort.NONE)
    cycles, left = [], []
    for each in calls.arguments:
        arguments = copied(each)
        arrays = [arguments[position] for position in kernel.array_positions]
        work = kernel.prepare(code, arrays, code.new_totals()).run(*arguments)
        cycles.append(work.issue_cclk + work.stall_cclk)
        left.append(checksum(arguments, work.value))
    return Predicted(tuple(cycles), of_all(left))


def of_all(checksums: Sequence[int]) -> str:
    """Return the checksum of the checksums of all calls of a kernel."""
    return fnv(np.array(checksums, np.uint32))


def frame_cycles(profile: CompilerProfile) -> Mapping[Kernel, float]:
    """Return what each kernel that a core ran costs of a stereo frame, on average; twins or not."""
    return {
        kernel: calls.per_frame * sum(predict(kernel, calls, profile).cycles) / len(calls.arguments)
        for kernel, calls in recorded().items()
    }
