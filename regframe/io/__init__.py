"""Images in and out: files, numpy arrays and SimpleITK images; files are written whole or not at all."""

from regframe.io.convert import from_sitk, to_sitk
from regframe.io.reading import coerce, digest, read, read_mask
from regframe.io.writing import atomic, refuse_existing, write

__all__ = [
    "atomic",
    "coerce",
    "digest",
    "from_sitk",
    "read",
    "read_mask",
    "refuse_existing",
    "to_sitk",
    "write",
]
