"""Where is the robot? `python localize.py RECORDING`: plays a drive, and localizes the robot by what the vision sensor reports.

The vision sensor is the built-in firmware on the simulated board; its messages are taken where the robot takes them, at
the other end of the SPI. The wheels are simulated: the recording's true way, with an error that is drawn from a seed.
Without RECORDING it is the built-in one.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from field import soccer_field
from numpy.typing import NDArray
from particle_filter import ParticleFilter, moved, turned_by
from sight import Eye, sight_of

from bfsim.api import Script
from bfsim.recording import RecordingReader
from bfsim.run import simulate
from bfsim.shipped import RECORDING
from tinyphoon import tinyphoon
from tinyphoon.strategy_unit.decoding import Results, decode_results
from tinyphoon.strategy_unit.messages import MessageType
from tinyphoon.strategy_unit.unit import StrategyUnit

Pose = NDArray[np.float64]
"""x and y in mm, heading in radians."""

# Errors of the simulated wheels: of the whole way, of the whole turn, and a drift for each step. [assumed]
WHEEL_WAY, WHEEL_TURN, WHEEL_DRIFT_RAD = 0.03, 0.05, np.radians(0.4)


@dataclass(frozen=True, slots=True)
class Step:
    """A frame: where the robot was, where it takes itself to be, how far its particles scatter, and where the wheels alone have it."""

    true: Pose
    estimated: Pose
    scatter_mm: float
    wheels: Pose

    @property
    def error_mm(self) -> float:
        """How far off the place is."""
        return float(np.linalg.norm(self.estimated[:2] - self.true[:2]))

    @property
    def error_deg(self) -> float:
        """How far off the heading is, to either side."""
        return math.degrees(abs(float(turned_by(self.estimated[2:] - self.true[2:])[0])))

    @property
    def wheels_error_mm(self) -> float:
        """How far off the place would be by the wheels alone, which start at the true one."""
        return float(np.linalg.norm(self.wheels[:2] - self.true[:2]))


def messages_of(recording: Path) -> list[Results]:
    """Return what the vision sensor reports in each frame of a recording."""
    units: list[StrategyUnit] = []

    def unit(script: Script) -> StrategyUnit:
        units.append(StrategyUnit(script))
        return units[-1]

    simulate(recording, firmware=replace(tinyphoon, spi=unit))
    reported = (each.message for each in units[-1].received)
    return [decode_results(each.payload) for each in reported if each.type is MessageType.RESULTS]


def known_of(recording: Path) -> tuple[Eye, list[Pose]]:
    """Return the left camera of a rendered recording, and where the robot was in each frame."""
    with RecordingReader(recording) as reader:
        geometry, cameras = (
            reader.geometry,
            [frame.truth["cameras"] for frame in reader.frames() if frame.truth],
        )
        size = reader.width, reader.height
    if geometry is None or not cameras:
        raise SystemExit(f"{recording} must be a rendered recording, with geometry and ground truth")
    height_mm, tilt_deg = geometry.stance
    eye = Eye(
        focal_px=geometry.focal_px,
        centre_px=((size[0] - 1) / 2, (size[1] - 1) / 2),
        baseline_mm=geometry.baseline_mm,
        height_mm=height_mm,
        tilt=math.radians(tilt_deg),
    )
    return eye, [_pose(each["left"], each["right"]) for each in cameras]


def _pose(left: dict[str, list[float]], right: dict[str, list[float]]) -> Pose:
    middle = (np.array(left["position_mm"]) + np.array(right["position_mm"])) / 2
    forward = np.array(left["rotation"])[2]
    return np.array([middle[0], middle[1], math.atan2(forward[1], forward[0])])


def localize(eye: Eye, truth: Sequence[Pose], messages: Sequence[Results], seed: int = 2007) -> list[Step]:
    """Return each frame of a drive: the particles move as the wheels say, and are weighted by the message."""
    random = np.random.default_rng(seed)
    way_scale, turn_scale = 1 + WHEEL_WAY * random.normal(), 1 + WHEEL_TURN * random.normal()
    particles = ParticleFilter(soccer_field(), seed)
    wheels, before, steps = truth[0], truth[0], []
    for message in messages:
        true = truth[message.frame]
        way_mm = way_scale * float(np.linalg.norm(true[:2] - before[:2]))
        turn = turn_scale * float(true[2] - before[2]) + WHEEL_DRIFT_RAD * random.normal()
        particles.move(way_mm, turn)
        wheels = moved(wheels[None], np.array([way_mm]), np.array([turn]))[0]
        particles.see(sight_of(message, eye))
        estimated, scatter_mm = particles.estimate()
        steps.append(Step(true, estimated, scatter_mm, wheels))
        before = true
    return steps


def main() -> None:
    """Print where the robot takes itself to be, frame by frame."""
    parser = argparse.ArgumentParser(description="Localize a robot by what its vision sensor reports.")
    parser.add_argument("recording", nargs="?", type=Path, default=RECORDING, help="a rendered drive")
    parser.add_argument("--seed", type=int, default=2007, help="of the particles and of the wheels' errors")
    asked = parser.parse_args()
    steps = localize(*known_of(asked.recording), messages_of(asked.recording), asked.seed)
    print("frame   x mm   y mm   deg   off mm   off deg   scatter mm   wheels off mm")
    for number, each in enumerate(steps):
        x, y, heading = each.estimated
        print(
            f"{number:5} {x:6.0f} {y:6.0f} {math.degrees(heading):5.1f} {each.error_mm:8.0f} {each.error_deg:9.1f} "
            f"{each.scatter_mm:12.0f} {each.wheels_error_mm:15.0f}"
        )


if __name__ == "__main__":
    main()
