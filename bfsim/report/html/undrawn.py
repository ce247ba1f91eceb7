"""What was seen in each frame of a run, kept until it is known which frames a page shows."""

from __future__ import annotations

import pickle
import zlib
from typing import Self

from bfsim.files.spool import Spool
from bfsim.report.html.pictures import overlay_shrinker, overlay_webp, picture_uri
from bfsim.seen import SeenFrame


class UndrawnFrames:
    """The frames of a run, outside of memory, for a page that shows some of them. A context manager.

    Keeping a frame takes a tenth of the time of drawing it. Raises ConfigError if there is no room for its file.
    """

    def __init__(self, pictures: int) -> None:
        self._small = overlay_shrinker(pictures)
        self._spool = Spool()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._spool.__exit__()

    def add(self, frame: SeenFrame) -> None:
        """Keep what was seen in a frame."""
        self._spool.put(frame.index, zlib.compress(pickle.dumps(frame), level=1))

    def picture_uri(self, index: int) -> str:
        """Return the picture of what was seen in a frame as a data URI; "" if the frame was not seen."""
        if index not in self._spool:
            return ""
        frame: SeenFrame = pickle.loads(zlib.decompress(self._spool[index]))  # noqa: S301  # a file without a name: nobody else's
        return picture_uri(overlay_webp(frame, self._small))
