"""Estimates beside the truth: kernels in C, compiled by the Blackfin's GCC, play recorded calls under the GNU simulator."""

from bfsim.verifying.sample import Sampler
from bfsim.verifying.toolchain import blackfin_toolchain
from bfsim.verifying.verify import require_compiler, verify

__all__ = ["Sampler", "blackfin_toolchain", "require_compiler", "verify"]
