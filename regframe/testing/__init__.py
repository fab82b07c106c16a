"""For those who write components: images with known answers, and the checks every component passes."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from regframe.testing.checks import Verdict, conformance, verify

__all__ = ["Verdict", "conformance", "verify"]


def __getattr__(name: str) -> object:
    # The demo uses the phantoms beside the checks, and should not wait for them.
    if name not in __all__:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    return getattr(import_module(f"{__name__}.checks"), name)
