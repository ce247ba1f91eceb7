"""A fit of centre and radius to the outline of a ball, finer than in the thesis [ours].

Rounds of least squares over the points near the circle: each moves centre and radius according to their distances and
directions (Gauss-Newton). The weight of a point is one over the variance of its place, which has three parts:

    PLACE^2 + (NOISE / steep)^2                              outside the circle
    PLACE^2 + (NOISE / steep)^2 + SHADE^2 (mean^2 / steep^2 - 1)   inside, where the outline is less steep than in the mean

PLACE is the error in the best of light: pixels are squares, and a profile runs along rows or columns. The camera's
noise moves a place in proportion to its ratio to the steepness. And where light falls off along the ball, less
brightness is gained at the outline and the rest behind it, over the next pixel or two: the edge lies further in, by
SHADE times how much steeper it would be in good light. It never lies further out. So on a ball in even light both sides
count alike, and the circle has no bias; on one that is lit from above it settles on the outermost points that agree.

The image of a sphere off the middle of the picture is no circle but an ellipse, longer towards the middle [ours]: its
outline is a cone of rays, which the picture cuts obliquely. To the first order it is a circle whose radius grows and
shrinks twice a turn, and the fit removes that bulge. It fits the centre and the mean radius of the ellipse.

The weight of a point also falls to nothing with its distance from the circle (Beaton and Tukey's weights), so that
things beside the ball, or on it, do not pull the circle over. If light comes from one side, the first circle is that of
the lit part alone, and the fit continues until it stands still.

Blur moves a curved outline [ours]. It mixes each point with those beside it, which lie further in: by v / 2r with the
variance v of the blur and the radius r, on a profile along a ray; on profiles oblique to the outline by less, for they
rise longer outside it. So at the end the radius grows by v / 2r, and v is taken from the rises of the profiles: from
how broad they are between their flanks, where a little blur is seen fully and much blur less so, as in the shift.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32
from tinyphoon.arithmetic import angle8, isqrt32
from tinyphoon.geometry import GEOMETRY_FOCAL, GEOMETRY_SHIFT_X, GEOMETRY_SHIFT_Y
from tinyphoon.stages.circle_edges import FINE
from tinyphoon.stages.line_fit import spread
from tinyphoon.stores.lines import SUBPIXELS

# What is fitted, and its inputs, in one array of words.
CENTRE_X = 0  # 1/64 px
CENTRE_Y = 1
RADIUS = 2
WEIGHT = 3  # of the points near the circle; the next words are weighted sums over them
SUM_NX = 4  # of their unit vectors from the centre, 1/128
SUM_NY = 5
SUM_NXX = 6
SUM_NXY = 7
SUM_NYY = 8
SUM_E = 9  # of their distances outside the circle, 1/64 px
SUM_NXE = 10
SUM_NYE = 11
NEXT_EDGE = 12  # number of selected edges that have been refined
REFINED = 13  # how many of them became points
BULGE_COSINE = (
    14  # of the radius, in 1/4096: how much it grows along the picture's axes, and along its diagonals
)
BULGE_SINE = 15
RISE_SUM = 16  # of the rises of all outlines, each times its steepness
SQUARE_SUM = 17  # the same, times the square of its distance from the greatest, in px
FIT_WORDS = 18
BULGE_BITS = 12
FARTHEST_OFF = 511  # px from the principal point; two squares of it fit above BULGE_BITS

# Parts of the variance of a place, relative to PLACE^2: an eighth of a pixel, the scatter of points of sharp outlines.
NOISE = 256  # (2 grey levels / PLACE)^2; divided by steepness squared
SHADE = 16  # (1/2 px / PLACE)^2: a gain over the next pixel is half a pixel further in

# The weight of a point, 255 at most: inside the circle, and outside in the bits above.
OUTSIDE_BITS = 8
MOST = 255

TAPER = 64  # the weight on the circle, falling to both sides
TAPER_BITS = 16
WEIGHT_BITS = (
    9  # are left out of the product: 32 at most, so that the sums over 3 rows of edges stay in 32 bits
)
NORMAL_BITS = 7

# Edges stand on whole pixels, and smoothing moves them by up to one; perspective makes ellipses of near balls.
NEAR = FINE
NEAR_BITS = 4  # a sixteenth of the radius
NEAR_POINTS = 37  # 4.7 times PLACE: for normal scatter, this weighted mean has 95 % of the best efficiency

# A rise is a pixel wide and up to half a pixel off the middle of the outline: a twelfth of a px^2 each.
OWN_SQUARE = FINE // 6

STILL = FINE // SUBPIXELS // 2  # half a step of a circle's stored numbers

# The product of the variances of the unit vectors, along and across, is 1/4 on a whole circle and 1/1000 on an arc of
# 80 degrees. A shorter arc hardly tells a far centre from a near one: it only moves the radius.
SHORTEST_ARC = 1 << 10  # in parts of 1 << 20

SECTOR_BITS = 3  # of the 8 of an angle: a circle has 32 sectors of 8


@kernel
def distance(x: i32, y: i32, fit: i32[:]) -> i32:
    """Return the distance of a point from the centre, both in 1/64 px."""
    dx = x - fit[CENTRE_X]
    dy = y - fit[CENTRE_Y]
    return i32(isqrt32(u32(dx * dx) + u32(dy * dy)))


@kernel
def expect_bulge(fit: i32[:], geometry: i32[:], width: i32, height: i32) -> None:
    """Set the bulge of a sphere whose image is centred on the circle's centre, in a picture of `width` by `height`.

    With the distance r from the principal point and the focal length f, the half axes are (1 + e) and (1 - e) times
    their mean, e = r^2 / (f + sqrt(f^2 + r^2))^2.
    """
    focal = geometry[GEOMETRY_FOCAL] // SUBPIXELS
    middle_x = (width - 1) * (FINE >> 1) + geometry[GEOMETRY_SHIFT_X] * (FINE // SUBPIXELS)
    middle_y = (height - 1) * (FINE >> 1) + geometry[GEOMETRY_SHIFT_Y] * (FINE // SUBPIXELS)
    x = min(max((fit[CENTRE_X] - middle_x) // FINE, -FARTHEST_OFF), FARTHEST_OFF)
    y = min(max((fit[CENTRE_Y] - middle_y) // FINE, -FARTHEST_OFF), FARTHEST_OFF)
    reach = focal + i32(isqrt32(u32(focal * focal + x * x + y * y)))
    square = max(reach * reach, 1)
    fit[BULGE_COSINE] = (x * x - y * y << BULGE_BITS) // square
    fit[BULGE_SINE] = (2 * x * y << BULGE_BITS) // square


@kernel
def outside_of(nx: i32, ny: i32, away: i32, fit: i32[:]) -> i32:
    """Return how far outside the outline a point is, in 1/64 px: `away` from the centre by a unit vector in 1/128."""
    bulge = fit[BULGE_COSINE] * (nx * nx - ny * ny) + 2 * fit[BULGE_SINE] * nx * ny >> 2 * NORMAL_BITS
    return away - fit[RADIUS] - (fit[RADIUS] * bulge >> BULGE_BITS)


@kernel
def near_of(radius: i32) -> i32:
    """Return how far from a circle its points may be, in 1/64 px."""
    return max(NEAR, radius >> NEAR_BITS)


@kernel
def weigh(weights: u16[:], fit: i32[:]) -> None:
    """Convert the steepness of the outline at each point into its weights, inside the circle and outside."""
    count = fit[REFINED]
    squares = 0
    for number in range(count):
        squares = squares + weights[number] * weights[number]
    mean = squares // max(count, 1)
    for number in range(count):
        own = weights[number] * weights[number]
        noisy = own + NOISE
        inside = MOST * own // (noisy + SHADE * max(mean - own, 0))
        weights[number] = inside | MOST * own // noisy << OUTSIDE_BITS


@kernel
def sum_up(points: u32[:], weights: u16[:], count: i32, fit: i32[:], fit_range: i32) -> None:
    """Sum up the fit's inputs over the points nearer to the circle than `fit_range` 1/64 px."""
    widest = fit_range * fit_range
    scale = (TAPER << TAPER_BITS) // widest
    for word in range(WEIGHT, SUM_NYE + 1):
        fit[word] = 0
    for number in range(count):
        x = i32(points[number] & 0xFFFF)
        y = i32(points[number] >> 16)
        away = max(distance(x, y, fit), 1)
        nx = (x - fit[CENTRE_X] << NORMAL_BITS) // away
        ny = (y - fit[CENTRE_Y] << NORMAL_BITS) // away
        outside = outside_of(nx, ny, away, fit)
        if abs(outside) < fit_range:
            near = (widest - outside * outside) * scale >> TAPER_BITS
            counts = weights[number] >> OUTSIDE_BITS if outside > 0 else weights[number] & MOST
            weight = near * counts + (1 << WEIGHT_BITS - 1) >> WEIGHT_BITS
            fit[WEIGHT] = fit[WEIGHT] + weight
            fit[SUM_NX] = fit[SUM_NX] + weight * nx
            fit[SUM_NY] = fit[SUM_NY] + weight * ny
            fit[SUM_NXX] = fit[SUM_NXX] + weight * nx * nx
            fit[SUM_NXY] = fit[SUM_NXY] + weight * nx * ny
            fit[SUM_NYY] = fit[SUM_NYY] + weight * ny * ny
            fit[SUM_E] = fit[SUM_E] + weight * outside
            fit[SUM_NXE] = fit[SUM_NXE] + weight * nx * outside
            fit[SUM_NYE] = fit[SUM_NYE] + weight * ny * outside


@kernel
def move_circle(fit: i32[:], fit_range: i32) -> i32:
    """Move centre and radius to where the sums have them, the centre by at most `fit_range` along each axis.

    Without points both stay. Returns the largest change of the three numbers.
    """
    weight = fit[WEIGHT]
    if weight == 0:
        return 0
    # the mean products of unit vectors in 1/4096, those with distances in 1/256 of 1/64 px
    xx = spread(fit[SUM_NXX], fit[SUM_NX], fit[SUM_NX], weight) // weight >> 2
    xy = spread(fit[SUM_NXY], fit[SUM_NX], fit[SUM_NY], weight) // weight >> 2
    yy = spread(fit[SUM_NYY], fit[SUM_NY], fit[SUM_NY], weight) // weight >> 2
    xe = 2 * (spread(fit[SUM_NXE], fit[SUM_NX], fit[SUM_E], weight) // weight)
    ye = 2 * (spread(fit[SUM_NYE], fit[SUM_NY], fit[SUM_E], weight) // weight)
    size = xx * yy - xy * xy >> 4
    along_x = 0
    along_y = 0
    if size >= SHORTEST_ARC:
        along_x = (xe * yy - ye * xy + (size >> 1)) // size
        along_y = (ye * xx - xe * xy + (size >> 1)) // size
        along_x = min(max(along_x, -fit_range), fit_range)
        along_y = min(max(along_y, -fit_range), fit_range)
        fit[CENTRE_X] = fit[CENTRE_X] + along_x
        fit[CENTRE_Y] = fit[CENTRE_Y] + along_y
    # halves of the sums: their products with four pixels stay in 32 bits
    towards = (fit[SUM_NX] >> 1) * along_x + (fit[SUM_NY] >> 1) * along_y >> NORMAL_BITS - 1
    larger = (2 * (fit[SUM_E] - towards) + weight) // (2 * weight)
    fit[RADIUS] = fit[RADIUS] + larger
    return max(max(abs(along_x), abs(along_y)), abs(larger))  # noqa: PLW3301 (in a kernel max has two)


@kernel
def take_off_blur(fit: i32[:]) -> None:
    """Enlarge the radius by how far blur has moved the outline of a circle inwards."""
    square = fit[SQUARE_SUM] // max(fit[RISE_SUM] // FINE, 1) - OWN_SQUARE
    if square > 0:
        radius = max(fit[RADIUS], FINE)
        fit[RADIUS] = fit[RADIUS] + (FINE * square + radius) // (2 * radius)


@kernel
def fit_circle(points: u32[:], weights: u16[:], fit: i32[:], fit_range: i32, rounds: i32) -> None:
    """Fit centre and radius to the points near the circle, until they stay or `rounds` times; `weights` has steepnesses.

    Near is `fit_range` pixels at first, then half as far each time, but not less than points of a circle may scatter.
    """
    weigh(weights, fit)
    near = FINE * fit_range
    for _ in range(rounds):
        sum_up(points, weights, fit[REFINED], fit, near)
        moved = move_circle(fit, near)
        nearer = max(near >> 1, min(max(fit[RADIUS] >> NEAR_BITS, NEAR_POINTS), near))
        if moved <= STILL and nearer == near:
            break
        near = nearer
    take_off_blur(fit)


@kernel
def arc_of(points: u32[:], fit: i32[:], atan: u8[:]) -> i32:
    """Return how much of the circle has outline on it, in 256ths: its sectors with a point within a pixel."""
    sectors: u32 = 0
    for number in range(fit[REFINED]):
        x = i32(points[number] & 0xFFFF)
        y = i32(points[number] >> 16)
        away = max(distance(x, y, fit), 1)
        nx = (x - fit[CENTRE_X] << NORMAL_BITS) // away
        ny = (y - fit[CENTRE_Y] << NORMAL_BITS) // away
        if abs(outside_of(nx, ny, away, fit)) <= FINE:
            angle = angle8(x - fit[CENTRE_X], y - fit[CENTRE_Y], atan)
            sectors = sectors | u32(1) << (angle >> SECTOR_BITS)
    arc: i32 = 0
    while sectors != 0:
        sectors = sectors & sectors - 1
        arc = arc + (1 << SECTOR_BITS)
    return arc
