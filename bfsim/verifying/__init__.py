"""Estimates beside the truth: kernels in C, compiled by the Blackfin's GCC, play recorded calls under the GNU simulator."""

from bfsim.verifying.sample import Sampler
from bfsim.verifying.verify import verify

__all__ = ["Sampler", "verify"]
