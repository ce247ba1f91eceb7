"""From the name of a scene to files: its recording, and chessboard pictures of its cameras."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.importer import Progress
from bfsim.recording.scenes.catalog import THESIS, scenes_named
from bfsim.recording.scenes.chessboard import write_chessboards
from bfsim.recording.scenes.lens import Misfit
from bfsim.recording.scenes.studio import record_scene


def render(
    name: str,
    output: str | os.PathLike[str],
    *,
    frames: int | None = None,
    samples: int | None = None,
    distances_mm: Sequence[float] | None = None,
    geometry: StereoGeometry | None = None,
    misfit: Misfit | None = None,
    chessboards: str | os.PathLike[str] | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> list[Path]:
    """Render the scene `name` to the recording `output`, or all thesis scenes to the folder `output`.

    frames and samples (light paths a pixel) are the scene's own by default, distances_mm and geometry too. With a
    misfit the cameras are real ones; the folder `chessboards` takes pictures of a chessboard by the same cameras.
    An existing recording needs `force`. Returns the recordings. Raises RecordingError.
    """
    chosen = scenes_named(name, distances_mm, geometry)
    folder = Path(output) if name == THESIS else None
    paths = {each: folder / f"{each}.mcap" if folder else Path(output) for each in chosen}
    for path in paths.values():
        if path.exists() and not force:
            raise RecordingError(f"{path}: recording must not exist yet; `--force` overwrites it")
    if folder:
        _make(folder)
    if chessboards is not None:
        scene = next(iter(chosen.values()))
        _make(Path(chessboards))
        write_chessboards(Path(chessboards), scene.geometry, misfit or Misfit(), seed=scene.seed)
    counts = {each: len(scene.poses[:frames]) for each, scene in chosen.items()}
    done = 0

    def tell(of_scene: int) -> None:
        if progress is not None:
            progress(done + of_scene, sum(counts.values()))

    for each, scene in chosen.items():
        record_scene(scene, paths[each], frames=frames, samples=samples, misfit=misfit, progress=tell)
        done += counts[each]
    return list(paths.values())


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(f"{folder}: folder must be writable: {error.strerror}") from None
