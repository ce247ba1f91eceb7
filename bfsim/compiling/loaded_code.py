"""The object code of Python kernels in an address space, ready to be called kernel by kernel."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

from bfsim.blackfin.elf.image import Image, packed, unpacked
from bfsim.blackfin.execution.subroutines import LoadedImage
from bfsim.blackfin.timing.tables import GNU, Timing
from bfsim.compiling.object_code import ObjectCode
from bfsim.files import store
from bfsim.kernel import keys
from bfsim.kernel.language.function import Function
from bfsim.kernel.objects.compiled import CompiledObject, code_bytes, compiled_object
from bfsim.kernel.objects.places import Places


@dataclass
class LoadedCode:
    """Kernels by their object code, timed by `timing`. Each is translated once, when it is first asked for."""

    code: ObjectCode
    timing: Timing = GNU
    _compiled: dict[tuple[Function, bool], CompiledObject] = field(default_factory=dict)

    def __post_init__(self) -> None:
        image = _linked(self.code.octets)
        kernels = {self.code.symbol_of(each): each for each in self.code.names}
        of_file = {each.symbol: each for each in self.code.names}
        self._loaded, self._places = LoadedImage(image), Places(image, kernels, of_file)
        self._placed = self.timing.placed(image)

    @property
    def digest(self) -> str:
        """SHA-256 of the code, wherever and whenever it was compiled."""
        return self._loaded.image.code_digest

    def has(self, function: Function) -> bool:
        """Whether a kernel is a function of the code: helpers may be inlined in all of their callers."""
        return self.code.symbol_of(function) in self._places.image.symbols

    def code_bytes(self, function: Function) -> dict[str, int]:
        """Return the size of a kernel's code, and of each function that it calls."""
        return code_bytes(self.code.symbol_of(function), self._loaded, self._places)

    def compiled(self, function: Function, *, traced: bool = False) -> CompiledObject:
        """Return a kernel ready to run; `traced`: it reports its accesses to memory.

        Raises KernelError if the code has no function for it, for example if it is a helper that is inlined.
        """
        if (function, traced) not in self._compiled:
            symbol = self.code.symbol_of(function)
            self._compiled[function, traced] = compiled_object(
                function, symbol, self._loaded, self._places, self._placed, traced=traced
            )
        return self._compiled[function, traced]


def _linked(octets: bytes) -> Image:
    """Return the image of an object file: linked now, or kept."""
    key = keys.object_key(hashlib.sha256(octets).hexdigest(), "", "", "image")
    kept = store.load(key)
    if kept is None:
        from bfsim.blackfin.elf.linking import link  # most starts find all images
        from bfsim.blackfin.elf.objects import read_object

        kept = packed(link(read_object(octets, "kernels.o")))
        store.save(key, kept)
    return unpacked(kept)
