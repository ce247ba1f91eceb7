"""Pixels of 16 bits, of which a camera uses a part: the upper 8 of the used bits are kept."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.planes import Plane

FEWEST_BITS, MOST_BITS = 8, 16


def check_bits(bits: int | None) -> None:
    """Raise RecordingError unless a camera may use this many of 16 bits."""
    if bits is not None and not FEWEST_BITS <= bits <= MOST_BITS:
        raise RecordingError(f"`--bits` must be {FEWEST_BITS} to {MOST_BITS}, not {bits}")


def upper_bits(pixels: NDArray[Any], bits: int | None) -> Plane:
    """Return the upper 8 of the `bits` that a camera uses.

    Raises RecordingError if `bits` is not given, or if pixels have more.
    """
    darkest, brightest = int(pixels.min()), int(pixels.max())
    if bits is None:
        raise RecordingError(
            "pixels must have 8 bits, or 16 of which `bfsim record import --bits` says how many the camera uses, to take the upper "
            f"8 of these: the brightest one here, {brightest:,}, has {brightest.bit_length()}"
        )
    if darkest < 0 or brightest >> bits:
        odd = darkest if darkest < 0 else brightest
        advice = (
            f"; the lowest {MOST_BITS - bits} bits of all are 0, so that the upper {bits} are used: say `--bits {MOST_BITS}`"
            if are_uppermost(pixels, bits)
            else ""
        )
        raise RecordingError(f"pixels must fit into the bits of `--bits {bits}`, but one is {odd:,}{advice}")
    return (pixels >> (bits - FEWEST_BITS)).astype(np.uint8)


def are_uppermost(pixels: NDArray[Any], bits: int) -> bool:
    """Whether the camera may use the uppermost of the 16 bits, as some cameras do: all others are 0."""
    is_of_16 = pixels.min() >= 0 and not int(pixels.max()) >> MOST_BITS
    return bool(is_of_16 and not (pixels & ((1 << (MOST_BITS - bits)) - 1)).any())


def words(
    octets: bytes | NDArray[np.uint8], shape: tuple[int, int], *, is_big_endian: bool = False
) -> NDArray[np.uint16]:
    """Return pixels of two bytes each as rows and columns."""
    return np.frombuffer(octets, ">u2" if is_big_endian else "<u2").reshape(shape)
