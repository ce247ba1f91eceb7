"""Put into the page of the accuracy what the scripts find of the cycles of kernels: `python docs/made/accuracy.py`, after a change of any rule of cost.

Takes a minute. What the page says of the robot is put there by `docs/made/robot.py`.
"""

from __future__ import annotations

from statistics import median

from blocks import DOCS, put, table

from benchmarks import accuracy, firmware_accuracy
from benchmarks.accuracy import Batch, first_sight
from benchmarks.twins.measured import Role, measured

PAGE = DOCS / "accuracy.md"
LEVEL = "O2"
SETS: tuple[tuple[Role, str], ...] = (
    (Role.REFERENCE, "reference kernels, written before the model"),
    (Role.FIT, "kernels that rules were found with"),
    (Role.HELD_OUT, "held out: all that were new once"),
)
MAY = {
    "inlined": "inline static helpers",
    "calls": "call all helpers",
    "one_file": "see all kernels as one file",
}
SHOWN = 5  # kernels that are farthest off
LARGE = 25  # %


def at_first_sight() -> str:
    """Return how far off kernels were that nobody had looked at, batch by batch."""

    def cells(name: str, batch: Batch) -> tuple[str, ...]:
        errors = f"{batch.mean:.1f}", f"{batch.signed:+.1f}", f"{batch.largest:.1f}"
        return name, str(batch.kernels), *errors

    *batches, whole = first_sight(LEVEL)
    rows = [*(cells(str(number), each) for number, each in enumerate(batches, 1)), cells("all", whole)]
    off = [abs(each.first_sight.percent[LEVEL]) for each in measured().values() if each.first_sight]
    half, large = median(off), sum(each > LARGE for each in off)
    return (
        table(["batch", "kernels", "mean error at `gcc-O2`, %", "signed, %", "largest, %"], rows)
        + f"\n\nHalf of all were within {half:.1f} %, and {large} were off by more than {LARGE} %."
    )


def today() -> str:
    """Return how far off they are now."""
    rows = list(accuracy.compare(LEVEL))
    found = [(title, accuracy.summary(rows, role)) for role, title in SETS]
    return table(
        ["set", "kernels", "mean error, %", "largest, %"],
        [
            (title, f"{each['kernels']:.0f}", f"{each['mean']:.1f}", f"{each['largest']:.1f}")
            for title, each in found
        ],
    )


def of_the_firmware() -> str:
    """Return how far off the kernels of the built-in firmware are."""
    rows = firmware_accuracy.compare(LEVEL)

    def cells(variant: str) -> tuple[str, ...]:
        error = firmware_accuracy.frame_error(rows, variant)
        side = "high" if error.signed > 0 else "low"
        return MAY[variant], f"{abs(error.signed):.1f} % too {side}", f"{error.by_share:.1f} % off"

    plain = next(iter(MAY))
    farthest = sorted(rows, key=lambda each: -abs(each.error(plain)))[:SHOWN]
    named = ", ".join(f"`{each.kernel}` {each.error(plain):+.0f} %" for each in farthest)
    return (
        f"{len(rows)} of its kernels make up {firmware_accuracy.covered(rows, LEVEL):.1f} % of a frame's cycles.\n\n"
        + table(["GCC may", "estimate of a frame", "kernel by kernel, weighted by share"], map(cells, MAY))
        + f"\n\nThe largest deviations: {named}."
    )


if __name__ == "__main__":
    for name, text in (
        ("first sight", at_first_sight()),
        ("today", today()),
        ("firmware", of_the_firmware()),
    ):
        put(PAGE, name, text)
