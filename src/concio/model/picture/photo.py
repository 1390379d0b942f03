"""A picture with its scale: grey values on a grid of square pixels, x to the right and y up in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from concio.arguments import strict
from concio.errors import InputError
from concio.files import check_regular
from concio.kinematics.frames import cross
from concio.representation import short_repr

if TYPE_CHECKING:
    from PIL import Image

Array = np.ndarray
LUMINANCE = np.array([0.299, 0.587, 0.114])
"""Shares of red, green and blue in grey."""
LARGEST = 60_000_000
"""A picture of more pixels is refused."""
FINEST = 4_000_000
"""A rectified picture has at most about so many pixels."""


@short_repr
@dataclass(frozen=True, eq=False)
class Photo:
    """A grey picture in which a pixel is a square of known size.

    Parameters
    ----------
    grey : (rows, columns) array
        0 black to 1 white; the first row is the uppermost.
    pixel : float
        Side of a pixel [m].
    origin : (x, y)
        Lower left corner of the picture [m].

    Examples
    --------
    Two points that are 100 pixels apart on the picture are half a metre apart on the wall:

    >>> import numpy as np
    >>> from concio.trace import Photo
    >>> Photo(np.zeros((200, 300))).scaled((0, 0), (100, 0), 0.5).size
    (1.5, 1.0)
    """

    grey: Array
    pixel: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m]."""
        rows, columns = self.grey.shape
        return columns * self.pixel, rows * self.pixel

    def metres(self, pixels: Array) -> Array:
        """Return points (k, 2) in metres from columns and rows of pixel corners, counted from the upper left."""
        p = np.asarray(pixels, dtype=float)
        rows = self.grey.shape[0]
        return np.column_stack([p[:, 0], rows - p[:, 1]]) * self.pixel + self.origin

    def pixels(self, points: Array) -> Array:
        """Return columns and rows (k, 2) of points in metres."""
        p = (np.asarray(points, dtype=float) - self.origin) / self.pixel
        return np.column_stack([p[:, 0], self.grey.shape[0] - p[:, 1]])

    def scaled(self, a: Sequence[float], b: Sequence[float], distance: float) -> Photo:
        """Return the picture with the scale that gives two points a known distance.

        Parameters
        ----------
        a, b : (column, row)
            Two points [pixels].
        distance : float
            Between them [m].

        Raises
        ------
        InputError
            The points are one, or the distance is not positive.
        """
        apart = float(np.hypot(*np.subtract(a, b)))
        if not (apart > 0 and distance > 0 and np.isfinite(distance)):
            msg = f"two points {apart:g} pixels apart with a distance of {distance:g} m give no scale"
            raise InputError(msg, hint="click two different points and state how far they are apart")
        return replace(self, pixel=distance / apart)

    def rectified(self, corners: Sequence[Sequence[float]], width: float, height: float) -> Photo:
        """Return the part of the picture between four points, as a rectangle seen straight on.

        Parameters
        ----------
        corners : (4, 2)
            Lower left, lower right, upper right, upper left [pixels: column, row].
        width, height : float
            Of the rectangle [m].

        Raises
        ------
        InputError
            The points are no convex quadrilateral in this order, or the sizes are not positive.
        """
        quad = np.asarray(corners, dtype=float)
        _check_quadrilateral(quad, width, height)
        sides = np.hypot(*(np.roll(quad, -1, axis=0) - quad).T)
        fine = max(sides[[0, 2]].max() / width, sides[[1, 3]].max() / height)
        pixel = 1.0 / min(fine, float(np.sqrt(FINEST / (width * height))))
        columns, rows = max(2, round(width / pixel)), max(2, round(height / pixel))
        plane = homography(np.array([[0, rows], [columns, rows], [columns, 0], [0, 0]], dtype=float), quad)
        x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
        at = plane @ np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
        at = at[:2] / at[2] - 0.5
        grey = ndimage.map_coordinates(self.grey, at[::-1], order=1, mode="nearest").reshape(rows, columns)
        return Photo(grey, width / columns, (0.0, 0.0))


def _check_quadrilateral(quad: Array, width: float, height: float) -> None:
    if quad.shape != (4, 2) or not np.isfinite(quad).all():
        msg = "four points are needed"
        raise InputError(msg, hint="click lower left, lower right, upper right and upper left")
    ahead = np.roll(quad, -1, axis=0) - quad
    after = np.roll(ahead, -1, axis=0)
    turns = cross(ahead, after)
    if not (turns < 0).all():  # rows count downwards
        msg = (
            "the four points are no convex quadrilateral in the order lower left, lower right, upper right, upper left"
        )
        raise InputError(msg, hint="click the corners again, counter-clockwise from the lower left")
    if not (width > 0 and height > 0 and np.isfinite([width, height]).all()):
        msg = f"a rectangle of {width:g} x {height:g} m"
        raise InputError(msg, hint="state width and height in metres")


def homography(given: Array, wanted: Array) -> Array:
    """Return the matrix (3, 3) of the projective map that takes four points (4, 2) to four others."""
    rows = []
    for (x, y), (u, v) in zip(given, wanted, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
    found = np.linalg.solve(np.array(rows), wanted.ravel())
    return np.append(found, 1.0).reshape(3, 3)


@strict
def read_photo(path: Path | str, *, pixel: float = 1.0) -> Photo:
    """Return a picture from a PNG, JPEG or TIFF file.

    It stands as its EXIF orientation says, and as viewers show it; what is transparent is white.

    Parameters
    ----------
    path : Path or str
    pixel : float
        Side of a pixel [m].

    Raises
    ------
    InputError
        There is no such file, it is not a picture, or it is too large.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from matplotlib.image import imsave
    >>> from concio.trace import read_photo
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = f"{folder}/wall.png"
    ...     imsave(file, np.ones((40, 60)), cmap="gray", vmin=0.0, vmax=1.0)
    ...     read_photo(file, pixel=0.01).size
    (0.6, 0.4)
    """
    path = Path(path)
    check_regular(path, hint="give a PNG, JPEG or TIFF file")
    from PIL import Image, ImageOps, UnidentifiedImageError

    try:
        with path.open("rb") as file, Image.open(file) as picture:  # by name, Pillow garbles grey TIFF that it turns
            if picture.width * picture.height > LARGEST:
                msg = f"the picture has {picture.width} x {picture.height} pixels"
                raise InputError(msg, where=path.name, hint=f"reduce it to {LARGEST / 1e6:g} million pixels at most")
            picture.load()  # which turns a TIFF already
            return Photo(_grey(ImageOps.exif_transpose(picture)), pixel)
    except (OSError, ValueError, SyntaxError, RuntimeError, Image.DecompressionBombError) as error:
        told = "it is not a picture" if isinstance(error, UnidentifiedImageError) else error
        msg = f"this picture cannot be read: {told}"
        raise InputError(msg, where=path.name, hint="save it as PNG") from None


def _grey(picture: Image.Image) -> Array:
    """Return grey values from 0 to 1 of a picture in any mode; what is transparent is white."""
    if picture.mode in ("I", "F") or picture.mode.startswith("I;"):  # more than 8 bits, or floating-point values
        deep = np.nan_to_num(np.asarray(picture, dtype=float), posinf=0.0, neginf=0.0)
        low, high = float(deep.min()), float(deep.max())
        full = next((one for one in (1.0, 255.0, 65535.0) if high <= one), high)
        return np.asarray(np.clip((deep - min(low, 0.0)) / full, 0.0, 1.0))
    colours = np.asarray(picture.convert("RGBA"), dtype=float) / 255.0
    opaque = colours[..., 3]
    return np.asarray(opaque * (colours[..., :3] @ LUMINANCE) + 1.0 - opaque)
