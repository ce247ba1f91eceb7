"""From scenes to files: their recordings, and chessboard pictures of their cameras."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.growing_file import require_free
from bfsim.recording.importing.importer import Progress
from bfsim.recording.scenes.chessboard import write_chessboards
from bfsim.recording.scenes.lens import Misfit
from bfsim.recording.scenes.scene import Scene, SceneAtDistances, Scenes
from bfsim.recording.scenes.studio import record_scene


def render(
    scenes: Scenes,
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
    """Render a scene to the recording `output`, or several, each to a recording of its name in the folder `output`.

    frames and samples (light paths a pixel) default to the scene's own, as do distances_mm and geometry. With a misfit
    the cameras are real ones; pictures of a chessboard by these cameras go to the folder `chessboards`. An existing
    recording needs `force`. Returns the recordings. Raises RecordingError.
    """
    chosen = _by_path(scenes, Path(output), distances_mm, geometry)
    for path in chosen:
        require_free(path, force=force)
    if isinstance(scenes, Mapping):
        _make(Path(output))
    if chessboards is not None:
        scene = next(iter(chosen.values()))
        _make(Path(chessboards))
        write_chessboards(Path(chessboards), scene.geometry, misfit or Misfit(), seed=scene.seed)
    counts = {path: len(scene.poses[:frames]) for path, scene in chosen.items()}
    done = 0

    def tell(of_scene: int) -> None:
        if progress is not None:
            progress(done + of_scene, sum(counts.values()))

    for path, scene in chosen.items():
        record_scene(scene, path, frames=frames, samples=samples, misfit=misfit, progress=tell)
        done += counts[path]
    return list(chosen)


def _by_path(
    scenes: Scenes, output: Path, distances_mm: Sequence[float] | None, geometry: StereoGeometry | None
) -> dict[Path, Scene]:
    """Return the scenes to render, by their output files."""
    if isinstance(scenes, SceneAtDistances):
        return {output: scenes.scene(distances_mm, geometry)}
    if distances_mm is not None:
        raise RecordingError(
            "distances must be given for a scene that is made for distances, and for no other one"
        )
    chosen = (
        {output / f"{name}.mcap": scene for name, scene in scenes.items()}
        if isinstance(scenes, Mapping)
        else {output: scenes}
    )
    return {path: replace(scene, geometry=geometry or scene.geometry) for path, scene in chosen.items()}


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(f"{folder}: folder must be writable: {error.strerror}") from None
