"""``regframe warmup``: compile every kernel before it is needed."""

from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

if TYPE_CHECKING:
    from regframe.geometry import Grid
    from regframe.preset import Preset, Stage

FLAT, DEEP = (64, 80), (16, 32, 40)
ITERATIONS = 3


Presets = Annotated[
    list[str] | None,
    typer.Argument(metavar="[PRESET]...", help="Compile what these need; else what every shipped one needs."),
]


def warmup(presets: Presets = None, plugin: Plugins = None) -> None:
    """Compile kernels ahead, so that the first registration runs at full speed."""
    from regframe.engine.resampling import align
    from regframe.engine.run import register
    from regframe.errors import RegframeError
    from regframe.preset import load, shipped
    from regframe.testing.phantoms import smooth_pair
    from regframe.verdict.verdict import judge

    plugin_files.use(plugin)
    named = {name: load(name) for name in presets or shipped()}
    began = perf_counter()
    flat, deep = smooth_pair("multimodal", FLAT), smooth_pair("multimodal", DEEP)
    for name, preset in named.items():
        for axes, pair in (("2-D", flat), ("3-D", deep)):
            if not all(_takes(stage, pair.fixed.grid) for stage in preset.stages):
                continue
            start = perf_counter()
            try:
                result = register(_short(preset), pair.fixed, pair.moving)
            except RegframeError as error:
                # A preset may be unable to take so small a pair; its kernels are compiled all the same.
                typer.echo(f"{name} {axes}: skipped, {error}", err=True)
                continue
            # Judging and writing have kernels of their own.
            judge(result)
            align(pair.moving, pair.fixed.grid, result.warp)
            typer.echo(f"{name} {axes}: {perf_counter() - start:.2f} s")
    which = "Their" if presets else "All"
    typer.echo(f"{which} kernels are compiled and stored; {perf_counter() - began:.1f} s in all.")


def _short(preset: "Preset") -> "Preset":
    """The preset with few iterations, all pixels of the small pair, and splines of few cells."""
    from regframe.preset import load
    from regframe.transforms.bspline import BSpline

    values: dict[str, object] = {}
    for i, stage in enumerate(preset.stages):
        if isinstance(stage.transform, BSpline):
            values[f"stages.{i}.transform.mesh"] = [1]
        for j in range(len(stage.levels)):
            values |= {f"stages.{i}.levels.{j}.iterations": ITERATIONS, f"stages.{i}.levels.{j}.shrink": 1}
    return load(preset, values)


def _takes(stage: "Stage", grid: "Grid") -> bool:
    """Whether a stage can run on a grid of so many axes: its transform's, and its lists' lengths."""
    from regframe.geometry import Frame
    from regframe.optimizers.exhaustive import Exhaustive
    from regframe.preset import Search

    if grid.dim not in stage.transform.dimensions or (grid.dim == 3 and isinstance(stage.start, Search)):
        return False
    count = len(stage.transform.identity(Frame.about_centre(grid)))
    steps = stage.optimizer.number_of_steps if isinstance(stage.optimizer, Exhaustive) else None
    lists = (stage.scales, stage.weights, steps)
    return all(len(numbers) in (1, count) for numbers in lists if isinstance(numbers, tuple))
