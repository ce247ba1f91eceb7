"""Find scenes to render by their name: a built-in one, FILE.py:NAME, or PACKAGE:NAME."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeGuard

from bfsim import shipped
from bfsim.errors import RecordingError, shown, with_article
from bfsim.loading.locating import located
from bfsim.loading.modules import SHIPPED, import_own
from bfsim.recording.scenes import Scene, SceneAtDistances, Scenes


def load_scenes(name: str) -> Scenes:
    """Return the scene or scenes of this name. Raises RecordingError if there is none, else as `load_firmware`."""
    place, colon, attribute = name.rpartition(":")
    if not colon:
        return _built_in(name)
    module, _ = import_own(*located(place))
    found = getattr(module, attribute, None)
    if not _are_scenes(found):
        is_what = f"is {with_article(type(found).__name__)}" if hasattr(module, attribute) else "is missing"
        raise RecordingError(
            f"{name} must be a Scene, a SceneAtDistances or a dict of Scenes of bfsim.recording.scenes, but it {is_what}"
        )
    return found


def _built_in(name: str) -> Scenes:
    if name not in shipped.SCENES:
        known = ", ".join(shipped.SCENES)
        raise RecordingError(
            f"SCENE must be FILE.py:NAME, PACKAGE:NAME, or one of {known}, not {shown(name)}"
        )
    module, _ = import_own(shipped.SCENES_MODULE, SHIPPED)
    return module.SCENES[name]  # type: ignore[no-any-return]  # a test knows them


def _are_scenes(value: object) -> TypeGuard[Scenes]:
    if isinstance(value, Mapping):
        return bool(value) and all(
            isinstance(each, str) and isinstance(scene, Scene) for each, scene in value.items()
        )
    return isinstance(value, Scene | SceneAtDistances)
