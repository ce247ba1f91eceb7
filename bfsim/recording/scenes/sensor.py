"""A small CMOS sensor: linear light in, noisy 8-bit RGB out. The lens is ideal and the white balance is set.

The noise is drawn per colour and pixel, without the correlation that a Bayer mosaic adds.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Electrons of a saturated pixel, and the read noise, for the pixels (3.6 to 6 um) of VGA sensors of
# 2005 to 2007. [assumed]
FULL_WELL_ELECTRONS = 8000.0
READ_NOISE_ELECTRONS = 12.0


def expose(radiance: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return the picture (height, width, 3) that a sensor makes of `radiance`; 1 just saturates it."""
    electrons = rng.poisson(radiance.astype(np.float64) * FULL_WELL_ELECTRONS)
    read = electrons + rng.normal(0.0, READ_NOISE_ELECTRONS, electrons.shape)
    return np.rint(255 * _transfer(np.clip(read / FULL_WELL_ELECTRONS, 0.0, 1.0))).astype(np.uint8)


def _transfer(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the voltage 0..1 of light 0..1 by the camera curve of ITU-R BT.601-7, section 2.6.4."""
    return np.where(light < 0.018, 4.5 * light, 1.099 * light**0.45 - 0.099)
