"""Synthetic stereo scenes: rendered once with mitsuba, shipped as recordings with exact ground truth.

The optional extra `scenes` installs the renderer; nothing here is needed to run a recording.
World frame of every scene: millimetres, x towards the far goal, y to the left, z up, origin on the floor.
Pixels are counted as array indices: (0.0, 0.0) is the centre of the first pixel.
"""
