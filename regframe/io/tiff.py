"""TIFF files put into a form that SimpleITK reads without loss, and 64-bit ones written.

Read as they are, SimpleITK cuts 16-bit files that lack the photometric tag to 8 bits, takes float16 for
integers, mixes grey with its alpha, refuses 64 bits and tiles of more than 8, and stumbles over pages of
another size. Only the directory of tags is written anew: libtiff decodes the pixels.
"""

import struct
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from regframe.errors import ImageError
from regframe.io.tags import DEFAULTS, Tag, TiffFile

MAGICS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")

_KINDS = {1: "u", 2: "i", 3: "f", 4: "u"}
_DTYPES = {"u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "f2", "f4", "f8"}
_TILING = (Tag.LENGTH, Tag.WIDTH, Tag.TILE_LENGTH, Tag.TILE_WIDTH)
_WORD_BITS = 32


class Tiles(NamedTuple):
    """Sizes in pixels of a picture, and of the tiles that it is stored in."""

    length: int
    width: int
    tile_length: int
    tile_width: int

    @property
    def down(self) -> int:
        """Rows of tiles."""
        return -(-self.length // self.tile_length)

    @property
    def across(self) -> int:
        """Columns of tiles."""
        return -(-self.width // self.tile_width)

    def laid(self, column: NDArray[Any]) -> NDArray[Any]:
        """The picture of tiles that lie below each other; colour is a last axis of 3 or 4."""
        channels = column.shape[-1:] if column.shape[-1] in (3, 4) else ()
        inner = (self.down, self.across, self.tile_length, self.tile_width, *channels)
        pages = column.shape[: column.ndim - 2 - len(channels)]
        apart = column.reshape(*pages, *inner)
        together = np.moveaxis(apart, len(pages) + 2, len(pages) + 1)
        whole = (self.down * self.tile_length, self.across * self.tile_width)
        picture = together.reshape(-1, *whole, *channels)[:, : self.length, : self.width]
        return np.ascontiguousarray(picture).reshape(*pages, self.length, self.width, *channels)


@dataclass(frozen=True)
class Plan:
    """How a file is read: in which form SimpleITK gets it, and what then becomes of the pixels.

    Parameters
    ----------
    data : bytes or None
        The file in another form, None where it is fine as it is.
    dtype : number type of the stored samples
    hidden : bool
        Whether SimpleITK reads integers whose bits are samples of `dtype`.
    samples : int
        Values a pixel that SimpleITK finds side by side along a row.
    swapped : bool
        Whether the halves of 64-bit samples change places.
    flat : bool
        Whether it is grey of less than 8 bits, which SimpleITK reads as colour.
    tiles : Tiles or None
        What SimpleITK finds below each other.
    """

    data: bytes | None
    dtype: "np.dtype[Any]"
    hidden: bool = False
    samples: int = 1
    swapped: bool = False
    flat: bool = False
    tiles: Tiles | None = None

    def restore(self, array: NDArray[Any], name: str) -> NDArray[Any]:
        """The stored pixels of what SimpleITK read; half precision becomes single, grey loses its alpha."""
        if array.dtype.itemsize < min(self.dtype.itemsize, _WORD_BITS // 8):
            message = (
                f"{name}: its {8 * self.dtype.itemsize}-bit samples are stored in a way that leaves only "
                f"{8 * array.dtype.itemsize} bits when read. Save it as plain grey or RGB TIFF, or as PNG."
            )
            raise ImageError(message)
        pixels = array[..., 0].copy() if self.flat and array.ndim > 2 else array
        pixels = pixels.reshape(*pixels.shape[:-1], -1, 2)[..., ::-1] if self.swapped else pixels
        if self.hidden:
            pixels = np.ascontiguousarray(pixels).reshape(array.shape).view(self.dtype)
        if self.samples > 1:
            pixels = pixels.reshape(*pixels.shape[:-1], -1, self.samples)
            pixels = np.ascontiguousarray(pixels[..., 0]) if self.samples == 2 else pixels
        pixels = self.tiles.laid(pixels) if self.tiles else pixels
        return pixels.astype(np.float32) if pixels.dtype == np.float16 else pixels


def plan(data: bytes, name: str) -> Plan:
    """Decide how a TIFF file is read.

    Parameters
    ----------
    data : bytes
        The whole file.
    name : str

    Raises
    ------
    ImageError
        The directory is damaged, or samples are stored in a way that cannot be read.
    """
    try:
        return _planned(TiffFile.of(data), name)
    except (struct.error, KeyError, IndexError, OverflowError):
        message = (
            f"{name}: the TIFF file is damaged or truncated: its directory is incomplete. Copy it again."
        )
        raise ImageError(message) from None


def encode(array: NDArray[Any]) -> bytes:
    """A grey picture as the bytes of an uncompressed TIFF file, for number types that ITK does not write.

    Parameters
    ----------
    array : (ny, nx) array of numbers

    Examples
    --------
    >>> plan(encode(np.eye(3)), "eye").dtype
    dtype('float64')
    """
    pixels = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    head = b"II*\0" + struct.pack("<I", 8 + pixels.nbytes)
    tags = {
        Tag.WIDTH: array.shape[1],
        Tag.LENGTH: array.shape[0],
        Tag.BITS: 8 * array.dtype.itemsize,
        Tag.COMPRESSION: 1,
        Tag.PHOTOMETRIC: 1,
        Tag.OFFSETS: len(head),
        Tag.SAMPLES: 1,
        Tag.ROWS: array.shape[0],
        Tag.BYTES: pixels.nbytes,
        Tag.FORMAT: next(code for code, letter in _KINDS.items() if letter == array.dtype.kind),
    }
    file = TiffFile(head + pixels.tobytes(), "<", False)
    return file.data + file.packed({tag: file.entry(value) for tag, value in tags.items()}, 0)


def _planned(file: TiffFile, name: str) -> Plan:
    pages = list(file.directories())
    first = {tag: file.number(pages[0], tag) for tag in (Tag.WIDTH, Tag.LENGTH, *DEFAULTS)}
    kept = [page for page in pages if page is pages[0] or file.belongs(page, first)]
    tiles = Tiles(*(first[tag] for tag in _TILING)) if first[Tag.TILE_WIDTH] else None
    if min(tiles or (first[Tag.LENGTH], first[Tag.WIDTH])) < 1:
        raise IndexError
    dtype = _dtype(first, name)
    samples = first[Tag.SAMPLES]
    hidden = dtype == np.float16 or dtype.itemsize == 8
    split = dtype.itemsize == 8 or samples == 2
    changes: dict[int, int | None] = {}
    if Tag.PHOTOMETRIC not in pages[0]:
        changes[Tag.PHOTOMETRIC] = 2 if samples > 2 else 1
    if hidden:
        changes[Tag.FORMAT] = 1
    if split:
        changes |= _side_by_side(first, name)
    if tiles:
        changes |= _as_strips(first, changes.get(Tag.WIDTH), tiles, name)
    other = file.rewritten(kept, changes) if changes or len(kept) < len(pages) else None
    swapped = dtype.itemsize == 8 and (file.order == ">") != (sys.byteorder == "big")
    flat = first[Tag.BITS] < 8 and first[Tag.PHOTOMETRIC] <= 1
    return Plan(other, dtype, hidden, samples if split else 1, swapped, flat, tiles)


def _dtype(first: Mapping[Tag, int], name: str) -> "np.dtype[Any]":
    bits, kind = first[Tag.BITS], _KINDS.get(first[Tag.FORMAT], "?")
    code = f"{kind}{max(bits, 8) // 8}"
    if bits not in (1, 2, 4, 8, 16, 32, 64) or code not in _DTYPES:
        what = {"u": "integer", "i": "integer", "f": "floating point"}.get(kind, "complex")
        message = (
            f"{name}: TIFF samples of {bits} bits, {what}, cannot be read. "
            "Save it with integers of 8, 16 or 32 bits, or floating point of 16, 32 or 64 bits."
        )
        raise ImageError(message)
    return np.dtype(code)


def _side_by_side(first: Mapping[Tag, int], name: str) -> dict[int, int | None]:
    """Tags of the grey picture whose rows hold all samples of a pixel, in words of at most 32 bits."""
    bits, samples = first[Tag.BITS], first[Tag.SAMPLES]
    _refuse_planes(first, name)
    if first[Tag.PREDICTOR] != 1:
        message = (
            f"{name}: a TIFF file of {bits}-bit samples, {samples} a pixel, with a predictor cannot be read. "
            "Save it without, or as NRRD."
        )
        raise ImageError(message)
    factor = samples * max(bits // _WORD_BITS, 1)
    changes: dict[int, int | None] = {
        Tag.WIDTH: first[Tag.WIDTH] * factor,
        Tag.BITS: min(bits, _WORD_BITS),
        Tag.SAMPLES: 1,
        Tag.PHOTOMETRIC: 1,
        Tag.EXTRA: None,
    }
    if bits <= _WORD_BITS:
        changes[Tag.FORMAT] = 1 if bits == 16 else first[Tag.FORMAT]
    return changes


def _as_strips(first: Mapping[Tag, int], width: int | None, tiles: Tiles, name: str) -> dict[int, int | None]:
    """Tags of the picture in which all tiles lie below each other; `width` is that of rows side by side."""
    _refuse_planes(first, name)
    factor = (width or tiles.width) // tiles.width
    return {
        Tag.WIDTH: tiles.tile_width * factor,
        Tag.LENGTH: tiles.tile_length * tiles.down * tiles.across,
        Tag.ROWS: tiles.tile_length,
        Tag.TILE_WIDTH: None,
        Tag.TILE_LENGTH: None,
    }


def _refuse_planes(first: Mapping[Tag, int], name: str) -> None:
    if first[Tag.SAMPLES] > 1 and first[Tag.PLANAR] != 1:
        message = (
            f"{name}: a TIFF file of {first[Tag.BITS]}-bit samples, in tiles or of more than 32 bits, cannot "
            "be read with its channels in separate planes. Save them interleaved, or as NRRD."
        )
        raise ImageError(message)
