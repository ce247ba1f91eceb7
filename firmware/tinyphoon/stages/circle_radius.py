"""The radius of a circle: a peak in the histogram of the edges' distances from its centre (T §2.2.2, §5.2.4)."""

from __future__ import annotations

from bfsim.api import i32, kernel, u16, u32
from tinyphoon.stages.circle_edges import FINE, edge_x, edge_y
from tinyphoon.stages.circle_fit import distance


@kernel
def fill_histogram(selected: u32[:], count: i32, fit: i32[:], histogram: u16[:]) -> None:
    """Count the distances of edges from the centre, to the nearest pixel. Those beyond the last bin are left out."""
    for radius in range(len(histogram)):
        histogram[radius] = 0
    for number in range(count):
        edge = selected[number]
        radius = (distance(FINE * edge_x(edge), FINE * edge_y(edge), fit) + FINE // 2) // FINE
        if radius < len(histogram):
            histogram[radius] = histogram[radius] + 1


@kernel
def edges_round(histogram: u16[:], radius: i32, peak_reach: i32) -> i32:
    """Return how many edges are within `peak_reach` bins of a radius."""
    total = 0
    for each in range(max(radius - peak_reach, 0), min(radius + peak_reach, len(histogram) - 1) + 1):
        total = total + histogram[each]
    return total


@kernel
def find_radius(histogram: u16[:], peak_reach: i32) -> i32:
    """Return the middle of the bins with the most edges; of equal ones the first."""
    best = 0
    peak = 0
    for radius in range(len(histogram)):
        total = edges_round(histogram, radius, peak_reach)
        if total > best:
            best = total
            peak = radius
    return peak


@kernel
def mean_radius(histogram: u16[:], radius: i32, peak_reach: i32) -> i32:
    """Return the mean of the bins around a radius, in 1/64 px. One of them must have an edge."""
    total = 0
    moment = 0
    for each in range(max(radius - peak_reach, 0), min(radius + peak_reach, len(histogram) - 1) + 1):
        total = total + histogram[each]
        moment = moment + (each - radius) * histogram[each]
    return FINE * radius + (2 * FINE * moment + total) // (2 * total)
