"""Kernels' C through the Blackfin's compiler: object code, kept by what it was made of."""

from bfsim.compiling.object_code import ObjectCode, object_code, options_of
from bfsim.compiling.toolchain import Toolchain, blackfin_compiler, blackfin_toolchain

__all__ = ["ObjectCode", "Toolchain", "blackfin_compiler", "blackfin_toolchain", "object_code", "options_of"]
