"""The code of the user's files in memory: each file once, since its functions share its static variables."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bfsim.blackfin.execution.subroutines import LoadedImage
    from bfsim.kernel.objects.compiled import CompiledObject


@dataclass
class LoadedFiles:
    """What one core has loaded since the start of a run: it has variables of its own, at first with the files' values."""

    _images: dict[LoadedImage, LoadedImage] = field(default_factory=dict)
    _compiled: dict[Hashable, CompiledObject] = field(default_factory=dict)

    def image(self, image: LoadedImage) -> LoadedImage:
        """Return this core's own copy of an image."""
        if image not in self._images:
            self._images[image] = image.anew()
        return self._images[image]

    def once(self, key: Hashable, made: Callable[[], CompiledObject]) -> CompiledObject:
        """Return what is kept under a key, or make it now."""
        if key not in self._compiled:
            self._compiled[key] = made()
        return self._compiled[key]
