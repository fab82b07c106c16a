"""The directories of TIFF files: the tags that say how pixels are stored, read and written anew."""

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple


class Tag(IntEnum):
    """The tags that say how pixels are stored."""

    SUBFILE = 254
    WIDTH = 256
    LENGTH = 257
    BITS = 258
    COMPRESSION = 259
    PHOTOMETRIC = 262
    OFFSETS = 273
    SAMPLES = 277
    ROWS = 278
    BYTES = 279
    PLANAR = 284
    PREDICTOR = 317
    TILE_WIDTH = 322
    TILE_LENGTH = 323
    TILE_OFFSETS = 324
    TILE_BYTES = 325
    SUBDIRECTORIES = 330
    EXTRA = 338
    FORMAT = 339
    EXIF = 34665


class Entry(NamedTuple):
    """One tag's value as it is stored: type, number of values, and the value itself or where it is."""

    kind: int
    length: int
    field: bytes


Directory = dict[int, Entry]

_SHORT, _LONG = 3, 4
_LETTERS = {1: "B", _SHORT: "H", _LONG: "I", 16: "Q"}
DEFAULTS = {
    Tag.SUBFILE: 0,
    Tag.BITS: 1,
    Tag.PHOTOMETRIC: 1,
    Tag.SAMPLES: 1,
    Tag.PLANAR: 1,
    Tag.PREDICTOR: 1,
    Tag.TILE_WIDTH: 0,
    Tag.TILE_LENGTH: 0,
    Tag.FORMAT: 1,
}
"""What a tag that is missing says; that of the photometric tag is ours."""
_STRIPS: dict[int, int] = {Tag.TILE_OFFSETS: Tag.OFFSETS, Tag.TILE_BYTES: Tag.BYTES}
_REDUCED_OR_MASK = 0b101


@dataclass(frozen=True)
class TiffFile:
    """The bytes of a TIFF or BigTIFF file, and how to find and write its directories."""

    data: bytes
    order: str
    big: bool

    @classmethod
    def of(cls, data: bytes) -> "TiffFile":
        """The file of these bytes, byte order and size of offsets as its first four say."""
        return cls(data, "<" if data[:2] == b"II" else ">", b"+" in data[2:4])

    def read(self, code: str, at: int) -> tuple[Any, ...]:
        """Unpack the values of a `struct` code; N stands for the file's size type."""
        return struct.unpack_from(self.order + code.replace("N", "Q" if self.big else "I"), self.data, at)

    def write(self, code: str, *values: Any) -> bytes:
        """Pack values, as `read` unpacks them."""
        return struct.pack(self.order + code.replace("N", "Q" if self.big else "I"), *values)

    @property
    def record(self) -> str:
        """One tag's record."""
        return "HHQ8s" if self.big else "HHI4s"

    def directories(self) -> Iterator[Directory]:
        """The directory of every page."""
        head = "Q" if self.big else "H"
        (at,) = self.read("N", 8 if self.big else 4)
        passed: set[int] = set()
        while at:
            if at in passed:
                raise IndexError(at)
            passed.add(at)
            (count,) = self.read(head, at)
            start, step = at + struct.calcsize(head), struct.calcsize("<" + self.record)
            records = [self.read(self.record, start + i * step) for i in range(count)]
            yield {tag: Entry(*rest) for tag, *rest in records}
            (at,) = self.read("N", start + count * step)

    def number(self, page: Directory, tag: Tag) -> int:
        """The first number of a tag, or its default."""
        if tag not in page and tag in DEFAULTS:
            return DEFAULTS[tag]
        kind, length, field = page[tag]
        letter = _LETTERS[kind]
        if struct.calcsize(letter) * length <= len(field):
            return int(struct.unpack_from(self.order + letter, field)[0])
        return int(self.read(letter, struct.unpack(self.order + ("Q" if self.big else "I"), field)[0])[0])

    def belongs(self, page: Directory, first: Mapping[Tag, int]) -> bool:
        """Whether a page is a slice of the same volume, not a preview or a mask of it."""
        same = all(
            self.number(page, tag) == first[tag] for tag in (Tag.WIDTH, Tag.LENGTH, Tag.BITS, Tag.SAMPLES)
        )
        return same and not self.number(page, Tag.SUBFILE) & _REDUCED_OR_MASK

    def entry(self, value: int) -> Entry:
        """The stored form of one number."""
        kind = _SHORT if value < 1 << 16 else _LONG
        return Entry(kind, 1, self.write(_LETTERS[kind], value).ljust(8 if self.big else 4, b"\0"))

    def packed(self, page: Directory, following: int) -> bytes:
        """A directory's bytes; `following` is where the next one stands."""
        records = b"".join(self.write(self.record, tag, *page[tag]) for tag in sorted(page))
        return self.write("Q" if self.big else "H", len(page)) + records + self.write("N", following)

    def rewritten(self, pages: Sequence[Directory], changes: Mapping[int, int | None]) -> bytes:
        """The file with these pages alone, some tags changed, None for removed."""
        gone = {Tag.SUBDIRECTORIES, Tag.EXIF, *(tag for tag, value in changes.items() if value is None)}
        new = {tag: self.entry(value) for tag, value in changes.items() if value is not None}
        body = self.data + bytes(len(self.data) % 2)
        start, tail = len(body), b""
        for number, page in enumerate(pages, 1):
            kept = {_STRIPS.get(tag, tag): entry for tag, entry in page.items() if tag not in gone}
            changed = kept | new
            following = start + len(tail) + len(self.packed(changed, 0))
            tail += self.packed(changed, following if number < len(pages) else 0)
        place = 8 if self.big else 4
        head = body[:place] + self.write("N", start) + body[place + (8 if self.big else 4) :]
        return head + tail
