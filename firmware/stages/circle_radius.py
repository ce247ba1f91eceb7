"""The radius of a circle: a peak in the histogram of distances, and a fit of centre and radius (T §2.2.2, §5.2.4).

The fit is [ours]: rounds of least squares over the edges near the circle, each moving centre and radius by what their
distances and directions ask for (Gauss-Newton). It works in 1/64 px, with directions in 1/256.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16, u32
from firmware.arithmetic import isqrt32
from firmware.stages.circle_edges import FINE, edge_x, edge_y
from firmware.stages.line_fit import spread

# What is fitted and from what, both in one array of words.
CENTRE_X = 0  # 1/64 px
CENTRE_Y = 1
RADIUS = 2
NEAR = 3  # edges near the circle; below, sums over them
SUM_NX = 4  # of their unit vectors from the centre, 1/256
SUM_NY = 5
SUM_NXX = 6
SUM_NXY = 7
SUM_NYY = 8
SUM_E = 9  # of how far they lie outside the circle, 1/64 px
SUM_NXE = 10
SUM_NYE = 11
FIT_WORDS = 12

NORMAL_BITS = 8

# The product of the variances of the unit vectors, along and across, is 1/4 on a whole circle and 1/1000 on an arc of
# 80 degrees. A shorter one hardly tells a far centre from a near one: it moves the radius only.
SHORTEST_ARC = 1 << 10  # in parts of 1 << 20


@kernel
def distance(edge: u32, fit: i32[:]) -> i32:
    """Return the distance of an edge from the centre, in 1/64 px."""
    dx = FINE * edge_x(edge) - fit[CENTRE_X]
    dy = FINE * edge_y(edge) - fit[CENTRE_Y]
    return i32(isqrt32(u32(dx * dx) + u32(dy * dy)))


@kernel
def fill_histogram(selected: u32[:], count: i32, fit: i32[:], histogram: u16[:]) -> None:
    """Count the distances of edges from the centre, to the nearest pixel. Those beyond the last bin are left out."""
    for radius in range(len(histogram)):
        histogram[radius] = 0
    for number in range(count):
        radius = (distance(selected[number], fit) + FINE // 2) // FINE
        if radius < len(histogram):
            histogram[radius] = histogram[radius] + 1


@kernel
def edges_round(histogram: u16[:], radius: i32, peak_reach: i32) -> i32:
    """Return how many edges are not further than `peak_reach` bins from a radius."""
    total = 0
    for each in range(max(radius - peak_reach, 0), min(radius + peak_reach, len(histogram) - 1) + 1):
        total = total + histogram[each]
    return total


@kernel
def find_radius(histogram: u16[:], peak_reach: i32) -> i32:
    """Return the middle bin of those with the most edges; of equal ones the first."""
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
    """Return the mean of the bins round a radius, in 1/64 px. There must be an edge in one."""
    total = 0
    moment = 0
    for each in range(max(radius - peak_reach, 0), min(radius + peak_reach, len(histogram) - 1) + 1):
        total = total + histogram[each]
        moment = moment + (each - radius) * histogram[each]
    return FINE * radius + (2 * FINE * moment + total) // (2 * total)


@kernel
def sum_up(selected: u32[:], count: i32, fit: i32[:], fit_range: i32) -> None:
    """Sum up what the fit needs of the edges not further than `fit_range` pixels from the circle."""
    for word in range(NEAR, FIT_WORDS):
        fit[word] = 0
    for number in range(count):
        edge = selected[number]
        away = distance(edge, fit)
        outside = away - fit[RADIUS]
        if away > 0 and abs(outside) <= FINE * fit_range:
            nx = (FINE * edge_x(edge) - fit[CENTRE_X] << NORMAL_BITS) // away
            ny = (FINE * edge_y(edge) - fit[CENTRE_Y] << NORMAL_BITS) // away
            fit[NEAR] = fit[NEAR] + 1
            fit[SUM_NX] = fit[SUM_NX] + nx
            fit[SUM_NY] = fit[SUM_NY] + ny
            fit[SUM_NXX] = fit[SUM_NXX] + nx * nx
            fit[SUM_NXY] = fit[SUM_NXY] + nx * ny
            fit[SUM_NYY] = fit[SUM_NYY] + ny * ny
            fit[SUM_E] = fit[SUM_E] + outside
            fit[SUM_NXE] = fit[SUM_NXE] + nx * outside
            fit[SUM_NYE] = fit[SUM_NYE] + ny * outside


@kernel
def move_circle(fit: i32[:]) -> None:
    """Move centre and radius to where the sums have them. Without edges they stay."""
    edges = fit[NEAR]
    if edges == 0:
        return
    # the mean products of unit vectors in 1/4096, those with distances in 1/256 of 1/64 px
    xx = spread(fit[SUM_NXX], fit[SUM_NX], fit[SUM_NX], edges) // edges >> 4
    xy = spread(fit[SUM_NXY], fit[SUM_NX], fit[SUM_NY], edges) // edges >> 4
    yy = spread(fit[SUM_NYY], fit[SUM_NY], fit[SUM_NY], edges) // edges >> 4
    xe = spread(fit[SUM_NXE], fit[SUM_NX], fit[SUM_E], edges) // edges
    ye = spread(fit[SUM_NYE], fit[SUM_NY], fit[SUM_E], edges) // edges
    size = xx * yy - xy * xy >> 4
    along_x = 0
    along_y = 0
    if size >= SHORTEST_ARC:
        along_x = (xe * yy - ye * xy + (size >> 1)) // size
        along_y = (ye * xx - xe * xy + (size >> 1)) // size
        fit[CENTRE_X] = fit[CENTRE_X] + along_x
        fit[CENTRE_Y] = fit[CENTRE_Y] + along_y
    towards = fit[SUM_NX] * along_x + fit[SUM_NY] * along_y >> NORMAL_BITS
    fit[RADIUS] = fit[RADIUS] + (2 * (fit[SUM_E] - towards) + edges) // (2 * edges)


@kernel
def fit_circle(selected: u32[:], count: i32, fit: i32[:], fit_range: i32, rounds: i32) -> None:
    """Fit centre and radius to the edges near the circle, `rounds` times."""
    for _ in range(rounds):
        sum_up(selected, count, fit, fit_range)
        move_circle(fit)


@kernel
def widen_circle(fit: i32[:], edge_shift: i32) -> None:
    """Move the radius out by what the smoothing before the edges has pulled them in: `edge_shift` / 64 px by itself.

    Behind a smoothing of the variance s^2 the steepest place of a disc's border lies s^2 / 2r further in.
    """
    if fit[RADIUS] > 0:
        fit[RADIUS] = fit[RADIUS] + (2 * FINE * edge_shift + fit[RADIUS]) // (2 * fit[RADIUS])
