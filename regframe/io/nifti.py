"""NIfTI files checked before they are read: ITK fills what a truncated one lacks with arbitrary pixels."""

import gzip
import shutil
import struct
import zlib
from math import prod
from pathlib import Path
from typing import NamedTuple

from regframe.errors import ImageError

LONGEST_HEADER = 540


class Layout(NamedTuple):
    """Where a header keeps what tells the file's length: offsets in bytes, types as `struct` names them."""

    axes: str
    axes_at: int
    bits_at: int
    first: str
    first_at: int


_LAYOUTS = {348: Layout("8h", 40, 72, "f", 108), 540: Layout("8q", 16, 14, "q", 168)}
"""By the size of the header: NIfTI-1 and NIfTI-2."""


def unpack(path: Path, plain: Path, name: str) -> None:
    """Decompress a ``.nii.gz`` file.

    Given a compressed file, ITK takes the pixels of an uncompressed one of the same name beside it, and
    it does not notice where compressed data break off.

    Raises
    ------
    ImageError
        The compressed data are damaged or truncated.
    """
    try:
        with gzip.open(path) as packed, plain.open("wb") as unpacked:
            shutil.copyfileobj(packed, unpacked, 1 << 20)
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        message = f"{name}: the compressed data are damaged or truncated ({error}). Copy the file again."
        raise ImageError(message) from None


def check(plain: Path, name: str) -> None:
    """Refuse an uncompressed NIfTI file that is shorter than its header says.

    Raises
    ------
    ImageError
        It is truncated, or no NIfTI file.
    """
    with plain.open("rb") as file:
        header = file.read(LONGEST_HEADER)
    met = plain.stat().st_size
    wanted = _length(header)
    if wanted is None:
        message = f"{name}: the file is truncated, or no NIfTI file: its header is not one. Check its suffix."
        raise ImageError(message)
    if met < wanted:
        message = f"{name}: the file is truncated: {met} of {wanted} bytes are there. Copy it again."
        raise ImageError(message)


def _length(header: bytes) -> int | None:
    """Bytes that the whole file must have, or None if this is no header."""
    for order in "<>":
        try:
            layout = _LAYOUTS.get(struct.unpack_from(f"{order}i", header)[0])
            if layout is None:
                continue
            axes = struct.unpack_from(order + layout.axes, header, layout.axes_at)
            bits = struct.unpack_from(f"{order}h", header, layout.bits_at)[0]
            first = struct.unpack_from(order + layout.first, header, layout.first_at)[0]
        except struct.error:
            return None
        return int(first) + prod(map(int, axes[1 : axes[0] + 1])) * int(bits) // 8
    return None
