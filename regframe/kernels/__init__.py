"""Compiled inner loops; `per_sample` makes one of a formula."""

from regframe.kernels.samples import per_sample

__all__ = ["per_sample"]
