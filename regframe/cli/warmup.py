"""``regframe warmup``: compile every kernel before it is needed."""

from time import perf_counter
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from regframe.preset import Preset, Stage

FLAT, DEEP = (64, 80), (16, 32, 40)
ITERATIONS = 3


def warmup() -> None:
    """Compile all kernels ahead, so that the first registration runs at full speed."""
    from regframe.engine.run import register
    from regframe.errors import RegframeError
    from regframe.preset import load, shipped
    from regframe.testing.phantoms import smooth_pair

    began = perf_counter()
    flat, deep = smooth_pair("multimodal", FLAT), smooth_pair("multimodal", DEEP)
    for name in shipped():
        preset = load(name)
        jobs = [("2-D", flat)]
        if all(_takes_volumes(stage) for stage in preset.stages):
            jobs.append(("3-D", deep))
        for axes, pair in jobs:
            start = perf_counter()
            try:
                register(_short(preset), pair.fixed, pair.moving)
            except RegframeError as error:
                # A preset may be unable to take so small a pair; its kernels are compiled all the same.
                typer.echo(f"{name} {axes}: skipped, {error}", err=True)
                continue
            typer.echo(f"{name} {axes}: {perf_counter() - start:.2f} s")
    typer.echo(f"All kernels are compiled and stored; {perf_counter() - began:.1f} s in all.")


def _short(preset: "Preset") -> "Preset":
    from regframe.preset import load

    return load(
        preset,
        {
            f"stages.{i}.levels.{j}.{key}": value
            for i, stage in enumerate(preset.stages)
            for j in range(len(stage.levels))
            for key, value in (("iterations", ITERATIONS), ("shrink", 1))
        },
    )


def _takes_volumes(stage: "Stage") -> bool:
    from regframe.preset import Search

    searches = isinstance(stage.start, Search)
    return 3 in stage.transform.dimensions and isinstance(stage.scales, str) and not searches
