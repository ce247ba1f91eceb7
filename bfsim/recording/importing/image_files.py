"""An image file → its pixels, by Pillow: upright, and of deep grey ones the upper 8 bits."""

from __future__ import annotations

import struct
import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, ImageFile, ImageOps, UnidentifiedImageError

from bfsim.errors import RecordingError, cut
from bfsim.recording.frames import UyvyImage
from bfsim.recording.importing.deep_pixels import MOST_BITS, upper_bits
from bfsim.recording.planes import YuvPlanes

_DEEP = ";16"
"""In Pillow's names of modes with 16 bits a pixel: `I;16`, `RGB;16B`."""
_BRIGHTEST = (1 << MOST_BITS) - 1
_EIGHT_BIT_MODES = frozenset({"1", "L", "LA", "P", "PA", "RGB", "RGBA", "RGBX", "CMYK", "YCbCr"})


def picture_of_file(path: Path) -> UyvyImage:
    """Return an image as a camera would send it, UYVY; without its last column if the width is odd.

    Raises RecordingError if it cannot be read or is one pixel wide.
    """
    picture = load_image(path).convert("RGB")
    if picture.width < 2:
        raise RecordingError(f"{path}: image must be at least 2 pixels wide, not {picture.width}")
    return YuvPlanes.from_image(picture.crop((0, 0, picture.width // 2 * 2, picture.height))).to_uyvy()


def load_image(path: Path, bits: int | None = None) -> Image.Image:
    """Return the decoded image, upright according to its EXIF orientation; `bits` as in `decoded`.

    Raises RecordingError, with the file, if Pillow cannot read it or it is not one picture of 8 bits, or grey of 16.
    """
    try:
        return decoded(path, bits=bits)
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None


def decoded(
    file: Path | BytesIO, formats: tuple[str, ...] | None = None, *, bits: int | None = None
) -> Image.Image:
    """Return the image in a file of any format, or of one of `formats`, as `load_image`. Errors do not name the file.

    `bits`: how many the camera uses of 16-bit pixels. A PGM whose maximum is not 65,535 says that itself.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of files that Pillow reads all the same
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(file, formats=formats) as image:
                # A phone may store a smaller copy behind the picture (MPO).
                count = 1 if image.format == "MPO" else getattr(image, "n_frames", 1)
                is_deep = _has_deep_colours(image)
                deep_bits = MOST_BITS if _says_its_maximum(image) else bits
                image.load()
                upright = ImageOps.exif_transpose(image)
    except UnidentifiedImageError:
        kinds = " or ".join(formats) if formats else "an image that Pillow reads"
        raise RecordingError(f"file must be {kinds}, not something else") from None
    # Pillow's decoders report damage with any of these errors, and fail on it with those below.
    except (OSError, SyntaxError, ValueError, EOFError, Image.DecompressionBombError, Warning) as error:
        raise RecordingError(f"image must be readable: {error}") from None
    except (LookupError, TypeError, AttributeError, ArithmeticError, struct.error) as error:
        stumble = f"{type(error).__name__}: {cut(str(error))}"
        raise RecordingError(f"image must be whole, but Pillow stops in it ({stumble})") from None
    if count > 1:
        raise RecordingError(
            f"image must be one picture, not {count}; `--format video` reads GIF and animated PNG, and "
            "`magick in.webp -coalesce %03d.png` makes one file of each picture of others"
        )
    if upright.mode == "I" or upright.mode.startswith(f"I{_DEEP}"):
        return Image.fromarray(upper_bits(np.asarray(upright), deep_bits))
    if upright.mode not in _EIGHT_BIT_MODES:
        raise RecordingError(
            f"image must have pixels of 8 bits, or grey ones of 16, not the pixel format {upright.mode}"
        )
    if bits is not None and not (is_deep and bits == MOST_BITS):
        # Pillow keeps the upper 8 of 16 bits of colours.
        raise RecordingError(
            f"image must have grey pixels of 16 bits for `--bits {bits}`, not {'colours' if is_deep else 'pixels of 8'}"
        )
    return upright


def has_deep_colours(path: Path) -> bool:
    """Whether an image that could be loaded has colours of 16 bits in its file, of which Pillow keeps the upper 8."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with Image.open(path) as image:
            return _has_deep_colours(image)


def _has_deep_colours(image: ImageFile.ImageFile) -> bool:
    """Whether an unloaded image has colours of 16 bits."""
    return _DEEP in str(image.tile) and image.mode in _EIGHT_BIT_MODES


def _says_its_maximum(image: ImageFile.ImageFile) -> bool:
    """Whether an unloaded grey image states its maximum: Pillow stretches a PGM's maximum above 255 to 65,535."""
    if image.format != "PPM" or image.mode != "I":
        return False
    found = image.tile[0].args  # (mode, maximum), or a name if Pillow does not stretch
    return isinstance(found, tuple) and found[-1] != _BRIGHTEST
