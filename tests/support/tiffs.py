"""TIFF files with chosen tags, right and odd ones."""

import struct

import numpy as np

KINDS = {"u": 1, "i": 2, "f": 3, "c": 6}
WIDTH, LENGTH, BITS, COMPRESSION, PHOTOMETRIC, OFFSETS = 256, 257, 258, 259, 262, 273
SAMPLES, ROWS, BYTES, PLANAR, PREDICTOR, FORMAT = 277, 278, 279, 284, 317, 339


def page_tags(array):
    """Tags of an uncompressed page, samples of a pixel side by side."""
    samples = array.shape[2] if array.ndim == 3 else 1
    return {
        WIDTH: array.shape[1],
        LENGTH: array.shape[0],
        BITS: 8 * array.dtype.itemsize,
        COMPRESSION: 1,
        PHOTOMETRIC: 2 if samples > 2 else 1,
        SAMPLES: samples,
        ROWS: array.shape[0],
        BYTES: array.nbytes,
        FORMAT: KINDS[array.dtype.kind],
    }


def tiff(pages, changes=None, order="<", big=False):
    """Bytes of a TIFF file; `changes` are tags of every page, None for one that is left out.

    BITS and FORMAT are written once for all samples of a pixel.
    """
    size, head = ("Q", "Q") if big else ("I", "H")
    magic = {"<": b"II", ">": b"MM"}[order] + struct.pack(order + "H", 43 if big else 42)
    start = magic + (struct.pack(order + "HHQ", 8, 0, 16) if big else struct.pack(order + "I", 8))
    parts, at = [start], len(start)
    for number, page in enumerate(pages, 1):
        tags = {**page_tags(page), OFFSETS: 0, **(changes or {})}
        tags = {tag: value for tag, value in sorted(tags.items()) if value is not None}
        samples = tags[SAMPLES]
        several = {tag for tag in (BITS, FORMAT) if tag in tags and samples > 1}
        length = struct.calcsize(f"={head}{size}") + len(tags) * (20 if big else 12)
        beside = at + length
        pixels = beside + 2 * samples * len(several)
        tags[OFFSETS] = pixels
        following = pixels + page.nbytes + page.nbytes % 2
        body, extra = struct.pack(order + head, len(tags)), b""
        for tag, value in tags.items():
            if tag in several:
                values = struct.pack(f"{order}{samples}H", *[value] * samples)
                short = len(values) <= (8 if big else 4)
                field = values if short else struct.pack(order + size, beside + len(extra))
                extra += b"" if short else values
                body += struct.pack(order + "HH" + size, tag, 3, samples) + field.ljust(
                    8 if big else 4, b"\0"
                )
            else:
                body += struct.pack(order + "HH" + size, tag, 4, 1)
                body += struct.pack(order + "I", value).ljust(8 if big else 4, b"\0")
        body += struct.pack(order + size, following if number < len(pages) else 0)
        data = np.ascontiguousarray(page, page.dtype.newbyteorder(order)).tobytes()
        extra = extra.ljust(pixels - beside, b"\0")
        parts.append(body + extra + data + bytes(page.nbytes % 2))
        at = following
    return b"".join(parts)


def tiled(array, order="<", size=16):
    """Bytes of a TIFF file whose pixels lie in square tiles."""
    samples = array.shape[2] if array.ndim == 3 else 1
    down, across = (-(-length // size) for length in array.shape[:2])
    padded = np.zeros((down * size, across * size, *array.shape[2:]), array.dtype)
    padded[: array.shape[0], : array.shape[1]] = array
    tiles = [
        padded[size * i : size * (i + 1), size * j : size * (j + 1)]
        for i in range(down)
        for j in range(across)
    ]
    column = np.concatenate(tiles)
    whole = {WIDTH: array.shape[1], LENGTH: array.shape[0], 322: size, 323: size}
    data = bytearray(tiff([column], {**whole, OFFSETS: 0, 324: 0, 325: 0, ROWS: None, BYTES: None}, order))
    # Offsets and sizes of the tiles stand at the end, the tags point there.
    body = column.nbytes + column.nbytes % 2
    first, each = len(data) - body, size * size * samples * array.dtype.itemsize
    for tag, values in (
        (324, [first + each * i for i in range(len(tiles))]),
        (325, [each] * len(tiles)),
    ):
        at = data.index(struct.pack(order + "HHI", tag, 4, 1))
        listed = struct.pack(f"{order}{len(tiles)}I", *values)
        field = listed if len(tiles) == 1 else struct.pack(order + "I", len(data))
        data[at + 4 : at + 12] = struct.pack(order + "I", len(tiles)) + field
        data += listed
    return bytes(data)
