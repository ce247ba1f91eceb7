"""3-D edges and 3-D lines of real stereo pairs beside a dense matcher, and beside the true disparities where there are some.

The dense matcher is OpenCV's SGBM over all of the rows' disparities, with its check from left to right. It errs, too, above all
where things look alike. True disparities come with a pair, or are those of the plane of a chessboard whose corners OpenCV
finds in both pictures of a calibrated recording; then the dense matcher is judged like the 3-D edges, at the same pixels. At
the border of a near thing a pixel has two disparities, the thing's and that of what is behind: an edge is right where one of
the nine dense ones round it is near its own. `plain` is without that, the pixel's own alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.playing import Played
from benchmarks.real.sets import Disparities, PictureSet
from benchmarks.rectified.truths import truth_of
from bfsim.api import Seen
from bfsim.report.tables.table import percent
from tinyphoon.stages.stereo_lines import Correspondence
from tinyphoon.strategy.modes import INDOOR_FIELD, THESIS_FIELD

TITLE = "3-D edges and lines beside dense disparities"
COLUMNS = (
    "beside",
    "kind",
    "of them judged",
    "within 1 px %",
    "plain %",
    "over 5 px off %",
    "kept %",
    "wanted %",
    "right %",
    "right kept %",
)
NOTE = (
    "In % of those judged: where the dense disparity is known. Kept: how many 3-D edges there are of those that the thesis "
    "matches on the same edges, right or wrong; wanted: of those of both that are not too far away; right: of those within 1 px; "
    "right kept: how many of the thesis's that are within 1 px are among ours that are, at the same pixel. "
    "Beside the truth, which on chessboards is their plane, SGBM itself at the pixels of the 3-D edges."
)

NO_SHARES = ("",) * 4
"""Where there is nothing to keep."""

ALONE = {
    "send": [{"mode": {"stereo_edges": {
        "correspondence": int(Correspondence.NEAREST),
        "direction_range": THESIS_FIELD.stereo_edges.direction_range,
    }}}]
}  # fmt: skip
"""What orders the thesis's way: each edge is matched alone."""

NEAR_PX, FAR_PX = 1.0, 5.0
MOST_DISPARITIES = 128
STEPS_OF_LINE = 9
Points = NDArray[np.float64]
"""Rows of x, y and disparity, in pixels of the left picture."""


def sgbm(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> Disparities:
    """Return the disparities that OpenCV's semi-global matcher finds in a grey pair; NaN where it finds none."""
    block = 5
    matcher = cv2.StereoSGBM.create(
        minDisparity=0, numDisparities=MOST_DISPARITIES, blockSize=block, P1=8 * block**2, P2=32 * block**2,
        disp12MaxDiff=1, uniquenessRatio=10, speckleWindowSize=60, speckleRange=2, mode=cv2.STEREO_SGBM_MODE_HH,
    )  # fmt: skip
    padded = [
        cv2.copyMakeBorder(each, 0, 0, MOST_DISPARITIES, 0, cv2.BORDER_REPLICATE) for each in (left, right)
    ]
    found = matcher.compute(*padded)[:, MOST_DISPARITIES:].astype(np.float64) / 16
    return np.where(found > 0, found, np.nan)


def edge_points(left: Seen) -> Points:
    """Return the 3-D edges."""
    assert left.geometry
    edges = left.edges_3d
    at = edges.left_edges
    reach = left.geometry.focal_px * left.geometry.baseline_mm
    return np.column_stack([left.edges.x_px[at], left.edges.y_px[at], reach / edges.places_mm[:, 2]])


def line_points(left: Seen) -> Points:
    """Return points spread along the 3-D lines, their ends left out: those are where things end."""
    assert left.geometry
    geometry = left.geometry
    points = []
    for line in left.lines_3d:
        ends = [
            np.array(_on_picture(geometry.focal_px, geometry.principal_px, end))
            for end in (line.start_mm, line.end_mm)
        ]
        reach = geometry.focal_px * geometry.baseline_mm
        disparities = [reach / end[2] for end in (line.start_mm, line.end_mm)]
        for share in np.linspace(0, 1, STEPS_OF_LINE + 2)[1:-1]:
            x, y = (1 - share) * ends[0] + share * ends[1]
            points.append((x, y, (1 - share) * disparities[0] + share * disparities[1]))
    return np.array(points).reshape(-1, 3)


def _on_picture(
    focal_px: float, principal_px: tuple[float, float], place_mm: Sequence[float]
) -> tuple[float, float]:
    x, y, z = place_mm
    return principal_px[0] + focal_px * x / z, principal_px[1] + focal_px * y / z


def _around(points: Points, dense: Disparities, reach: int) -> NDArray[np.float64]:
    """Return the dense disparities within `reach` pixels of each point (count, pixels); NaN where they are not known."""
    height, width = dense.shape
    columns, rows = np.rint(points[:, :2].T).astype(int)
    steps = range(-reach, reach + 1)
    return np.stack(
        [
            dense[np.clip(rows + down, 0, height - 1), np.clip(columns + across, 0, width - 1)]
            for down in steps
            for across in steps
        ],
        axis=1,
    )


def errors_at(points: Points, dense: Disparities, reach: int) -> NDArray[np.float64]:
    """Return how far each point's disparity is from the nearest dense one around; NaN where there is none."""
    errors = np.abs(points[:, 2:] - _around(points, dense, reach))
    nearest: NDArray[np.float64] = np.where(np.isnan(errors), np.inf, errors).min(axis=1)
    return np.where(np.isinf(nearest), np.nan, nearest)


def _errors(points: Points, dense: Disparities, reach: int) -> NDArray[np.float64]:
    """Return how far each point's disparity is from the nearest dense one around; without those that have none."""
    errors = errors_at(points, dense, reach)
    return errors[~np.isnan(errors)]


def _wanted(left: Seen, points: Points, dense: Disparities) -> int:
    """Return how many points are nearer than the farthest depth."""
    assert left.geometry
    least_px = left.geometry.focal_px * left.geometry.baseline_mm / INDOOR_FIELD.stereo_edges.farthest_mm
    return int((np.nan_to_num(_around(points, dense, 1)) >= least_px).any(axis=1).sum())


def _right(frames: Sequence[Points], dense: Sequence[Disparities]) -> frozenset[tuple[float, ...]]:
    """Return frame, column and row of the points within 1 px of a dense disparity around."""
    return frozenset(
        (frame, *pixel)
        for frame, (points, own) in enumerate(zip(frames, dense, strict=True))
        for pixel in points[errors_at(points, own, 1) <= NEAR_PX, :2].tolist()
    )


@dataclass(frozen=True, slots=True)
class _Found:
    """3-D edges or lines of a set: points, how many were found with those that had no room, and the errors known.

    `wanted`: how many are, by the dense disparities, nearer than the farthest depth. `right`: frame, column and row of
    those within 1 px.
    """

    points: int
    count: int
    near: NDArray[np.float64]
    plain: NDArray[np.float64]
    wanted: int
    right: frozenset[tuple[float, ...]]

    @classmethod
    def of(
        cls,
        played: Sequence[Played[Seen]],
        points_of: Callable[[Seen], Points],
        dense: Sequence[Disparities],
    ) -> _Found:
        """Judge the points of all frames."""
        frames = [(each, points_of(each.taken["A"]), own) for each, own in zip(played, dense, strict=True)]
        near, plain = (
            np.concatenate([_errors(points, own, reach) for _, points, own in frames]) for reach in (1, 0)
        )
        count = sum(len(points) + each.results("A").get("edges_3d_lost", 0) for each, points, _ in frames)
        wanted = sum(_wanted(each.taken["A"], points, own) for each, points, own in frames)
        right = _right([points for _, points, _ in frames], dense)
        return cls(sum(len(points) for _, points, _ in frames), count, near, plain, wanted, right)

    @classmethod
    def of_dense(
        cls, played: Sequence[Played[Seen]], dense: Sequence[Disparities], truth: Sequence[Disparities]
    ) -> _Found:
        """Judge a dense matcher at the pixels of the 3-D edges of all frames, as if these had its disparities."""
        frames = []
        for each, own in zip(played, dense, strict=True):
            points = edge_points(each.taken["A"])
            points[:, 2] = _around(points, own, 0)[:, 0]
            frames.append(points[np.isfinite(points[:, 2])])
        near, plain = (
            np.concatenate([_errors(points, true, reach) for points, true in zip(frames, truth, strict=True)])
            for reach in (1, 0)
        )
        count = sum(len(points) for points in frames)
        return cls(count, count, near, plain, wanted=count, right=_right(frames, truth))

    def of_all(self, number: int) -> int:
        """Return how many of all there are if `number` of the judged are, and those without room are like the others."""
        return round(number * self.count / max(len(self.near), 1))


def rows_of(
    pictures: PictureSet, ours: Sequence[Played[Seen]], alone: Sequence[Played[Seen]]
) -> list[list[str]]:
    """Return the rows of the table for a set of stereo pairs, played our way and with each edge matched alone."""
    dense = {"SGBM": [sgbm(*pictures.lumas(frame)) for frame in pictures.frames]}
    truth = true_disparities(pictures)
    if truth:
        dense["truth"] = truth
    rows = []
    for kind, points_of in (("edges", edge_points), ("lines", line_points)):
        for beside, disparities in dense.items():
            found, all_ = (_Found.of(played, points_of, disparities) for played in (ours, alone))
            kept = _kept(found, all_) if kind == "edges" else NO_SHARES
            rows.append([beside, kind, *_cells(found), *kept])
    if truth:
        rows.append(["truth", "SGBM", *_cells(_Found.of_dense(ours, dense["SGBM"], truth)), *NO_SHARES])
    return rows


def true_disparities(pictures: PictureSet) -> Sequence[Disparities]:
    """Return the true disparities of each frame, NaN where unknown: none at all if they are unknown everywhere."""
    sources = pictures.calibration.sources
    if pictures.truth or not sources:
        return pictures.truth
    tables = {"left": sources["A"], "right": sources["B"]}
    truths = [truth_of(frame, tables) for frame in pictures.frames]
    if not any(truths):
        return ()
    unknown = np.full(tables["left"].rows.shape, np.nan)
    return [each.disparities if each else unknown for each in truths]


def _cells(found: _Found) -> list[str]:
    near, plain = found.near, found.plain
    return [
        f"{len(near)} of {found.points}",
        percent((near <= NEAR_PX).sum(), len(near)),
        percent((plain <= NEAR_PX).sum(), len(plain)),
        percent((near > FAR_PX).sum(), len(near)),
    ]


def _kept(found: _Found, all_: _Found) -> tuple[str, str, str, str]:
    right, all_right = ((each.near <= NEAR_PX).sum() for each in (found, all_))
    return (
        percent(found.count, all_.count),
        percent(found.of_all(found.wanted), all_.of_all(all_.wanted)),
        percent(found.of_all(right), all_.of_all(all_right)),
        percent(len(found.right & all_.right), len(all_.right)),
    )
