"""Scenes by their names: built in, and a user's own."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim import shipped
from bfsim.errors import BfsimError
from bfsim.loading.scenes import load_scenes
from bfsim.recording.scenes import Scene, SceneAtDistances
from tinyphoon.scenes import SCENES

OWN = """\
from dataclasses import replace
from tinyphoon.scenes.soccer import LIGHT, SOCCER

night = replace(SOCCER, light=replace(LIGHT, room_radiance=0.0))
both = {"day": SOCCER, "night": night}
nothing = {}
lamp = 3
"""


def test_the_names_of_built_in_scenes_are_those_that_there_are() -> None:
    """The help text knows them without importing them."""
    assert tuple(SCENES) == shipped.SCENES
    for name, scenes in SCENES.items():
        loaded = load_scenes(name)
        if isinstance(scenes, SceneAtDistances):
            assert isinstance(loaded, SceneAtDistances)
            assert loaded.scene() == scenes.scene()
        else:
            assert loaded == scenes


def test_a_scene_of_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a file, one scene or several, made from those that are built in."""
    (tmp_path / "mine.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    night = load_scenes("mine.py:night")
    assert isinstance(night, Scene)
    assert night.light.room_radiance == 0.0
    assert load_scenes("mine:both") == {"day": SCENES["soccer"], "night": night}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("socker", "SCENE must be FILE.py:NAME, PACKAGE:NAME, or one of soccer, .*, not 'socker'"),
        ("mine.py:lamp", "mine.py:lamp must be a Scene, .* of bfsim.recording.scenes, but it is an int"),
        ("mine.py:nothing", "but it is a dict"),
        ("mine.py:dusk", "but it is missing"),
        ("yours.py:night", "yours.py must be a file, but there is none"),
        ("yours:night", "the package 'yours' must be installed or in the folder"),
    ],
)
def test_names_of_no_scenes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, message: str) -> None:
    """What must be, and what is."""
    (tmp_path / "mine.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BfsimError, match=message):
        load_scenes(name)
