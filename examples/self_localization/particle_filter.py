"""A particle filter: many poses that a robot may have, moved as its wheels say and weighted by how well each explains what is seen.

A pose is x and y in mm and a heading in radians.
"""

from __future__ import annotations

import numpy as np
from field import Field, Points
from numpy.typing import NDArray
from sight import Sight

Numbers = NDArray[np.float64]

START_PARTICLES, PARTICLES = 12_000, 2_000
SURVIVORS = 200
KERNEL = (4 / (PARTICLES * 5)) ** (1 / 7)
"""Of the spread of all particles, for a density in three dimensions that is normal (Silverman)."""
WIDEST = np.array([60.0, 60.0, np.radians(4.0)])

# What the filter takes measurements to be off by; the tails are what is no landmark at all.
POST_RAD = np.radians(1.0)
GOAL_LINE_MM, BORDER_MM, PER_MM = 15.0, 6.0, 0.01
LINE_RAD = np.radians(3.0)
STRAY = 0.05
MOST_LINES = 6.0  # more lines than that tell no more: their errors have the same causes

# What the wheels may be off by: of the way and of the turn, and for each step.
SLIP, STEP_MM, STEP_RAD = 0.08, 3.0, np.radians(0.7)


class ParticleFilter:
    """The poses (n, 3) and what each of them weighs."""

    def __init__(self, field: Field, seed: int) -> None:
        """Begin anywhere in the own half of the field, looking into the other one."""
        self._field = field
        self._random = np.random.default_rng(seed)
        uniform = self._random.uniform
        x, y = uniform(-740, 0, START_PARTICLES), uniform(-640, 640, START_PARTICLES)
        self.poses = np.stack([x, y, uniform(-np.pi / 2, np.pi / 2, START_PARTICLES)], axis=1)
        self.weights = np.full(START_PARTICLES, 1 / START_PARTICLES)

    def move(self, way_mm: float, turn: float) -> None:
        """Let all particles drive an arc as the wheels have measured it, each with an error of its own."""
        count, normal = len(self.poses), self._random.normal
        ways = way_mm * normal(1, SLIP, count) + normal(0, STEP_MM, count)
        turns = turn * normal(1, SLIP, count) + normal(0, STEP_RAD, count)
        self.poses = moved(self.poses, ways, turns)

    def see(self, sight: Sight) -> None:
        """Weight all particles by what is seen, and draw them anew where few have most of the weight.

        What is seen counts in full only if enough particles survive it: while they are far apart, the one that is right is not
        among them, and the best of the wrong ones must not be all that is left.
        """
        logs = self._post_logs(sight) + self._goal_logs(sight) + self._border_logs(sight)
        part = 1.0
        while survivors(weights := weighted(self.weights, part * logs)) < SURVIVORS:
            part /= 2
        self.weights = weights
        if survivors(weights) < len(weights) / 2 or len(weights) > PARTICLES:
            self._draw()

    def estimate(self) -> tuple[Numbers, float]:
        """Return the mean of all particles, by their weights (T §6.5), and how far they scatter about its place in mm."""
        x, y = self.weights @ self.poses[:, :2]
        heading = np.angle(self.weights @ np.exp(1j * self.poses[:, 2]))
        scatter = np.sqrt(self.weights @ np.sum((self.poses[:, :2] - (x, y)) ** 2, axis=1))
        return np.array([x, y, heading]), float(scatter)

    def _draw(self) -> None:
        """Draw particles by their weights, at even steps, and spread each a little the way all of them are spread.

        Those drawn from the same one would stay together else, for wheels do not slip sideways (a regularized particle filter).
        """
        cloud = np.cov(self.poses.T, aweights=self.weights)
        least = np.minimum(
            1, WIDEST / np.sqrt(np.diag(cloud))
        )  # several clouds far apart are not one wide one
        cloud *= np.outer(least, least)
        steps = (np.arange(PARTICLES) + self._random.random()) / PARTICLES
        chosen = np.searchsorted(np.cumsum(self.weights), steps).clip(max=len(self.weights) - 1)
        spread = self._random.multivariate_normal(np.zeros(3), cloud, PARTICLES, method="cholesky")
        self.poses = self.poses[chosen] + KERNEL * spread
        self.weights = np.full(PARTICLES, 1 / PARTICLES)

    def _post_logs(self, sight: Sight) -> Numbers:
        logs = np.zeros(len(self.poses))
        for post, bearing in sight.posts:
            forward, left = of_robot(self._field.posts[post], self.poses).T
            off = turned_by(np.arctan2(left - sight.aside_mm, forward) - bearing)
            logs += believed((off / POST_RAD) ** 2)
        return logs

    def _goal_logs(self, sight: Sight) -> Numbers:
        """Both ends of the bottom line lie on the goal's line."""
        logs = np.zeros(len(self.poses))
        for ends in sight.goal_lines:
            scale = GOAL_LINE_MM + PER_MM * np.linalg.norm(ends, axis=-1)
            off = distances(in_world(ends, self.poses), self._field.goal_line[None])[..., 0]
            logs += believed(((off / scale) ** 2).mean(axis=-1))
        return logs

    def _border_logs(self, sight: Sight) -> Numbers:
        """Each border is one of the field's: its middle lies on it, and it runs the same way."""
        if not len(sight.borders):
            return np.zeros(len(self.poses))
        landmarks = self._field.borders
        runs = landmarks[:, 1] - landmarks[:, 0]
        angles = np.arctan2(runs[:, 1], runs[:, 0])
        logs = np.zeros(len(self.poses))
        for ends in sight.borders:
            middle, run = ends.mean(axis=0), ends[1] - ends[0]
            scale = BORDER_MM + PER_MM * np.linalg.norm(middle)
            off = distances(in_world(middle[None], self.poses), landmarks)[:, 0] / scale
            turn = turned_by(np.arctan2(run[1], run[0]) + self.poses[:, 2, None] - angles) / LINE_RAD
            logs += believed((off**2 + turn**2).min(axis=1))
        return logs * min(1.0, MOST_LINES / len(sight.borders))


def weighted(weights: Numbers, logs: Numbers) -> Numbers:
    """Return weights times what is likely by its logarithm, together 1."""
    likely = weights * np.exp(logs - logs.max())
    return likely / likely.sum()


def survivors(weights: Numbers) -> float:
    """Return how many particles of equal weight would say as much."""
    return float(1 / np.sum(weights**2))


def moved(poses: Points, ways: Numbers, turns: Numbers) -> Points:
    """Return poses (n, 3) after arcs of a length and a turn: the chord points half-way between the headings."""
    chords = ways * np.sinc(turns / (2 * np.pi))
    towards = poses[:, 2] + turns / 2
    return np.stack(
        [poses[:, 0] + chords * np.cos(towards), poses[:, 1] + chords * np.sin(towards), poses[:, 2] + turns],
        axis=1,
    )


def in_world(places: Points, poses: Points) -> Points:
    """Return places (m, 2), forward and left of a robot, in the world of each pose (n, m, 2)."""
    cosine, sine = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    forward, left = places[:, 0], places[:, 1]
    world = np.stack([cosine * forward - sine * left, sine * forward + cosine * left], axis=-1)
    return world + poses[:, None, :2]


def of_robot(place: Points, poses: Points) -> Points:
    """Return how far forward and left of each pose a place of the world (2,) is (n, 2)."""
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = (place - poses[:, :2]).T
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=-1)


def distances(places: Points, segments: Points) -> Points:
    """Return how far places (n, m, 2) are from segments (k, 2, 2): (n, m, k)."""
    start, run = segments[:, 0], segments[:, 1] - segments[:, 0]
    beyond = places[..., None, :] - start
    part = (np.sum(beyond * run, axis=-1) / np.sum(run**2, axis=-1)).clip(0, 1)
    return np.linalg.norm(beyond - part[..., None] * run, axis=-1)


def believed(squares: Numbers) -> Numbers:
    """Return the logarithm of how likely errors are, in squares of what is usual; a stray one says no more than that."""
    return np.log((1 - STRAY) * np.exp(-squares / 2) + STRAY)


def turned_by(angles: Numbers) -> Numbers:
    """Return angles in -pi to pi."""
    return (angles + np.pi) % (2 * np.pi) - np.pi
