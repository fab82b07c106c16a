"""``regframe apply``: an image through a transform that was found before."""

from pathlib import Path
from typing import Annotated

import typer

from regframe.cli import plugin_files
from regframe.cli.plugin_files import Plugins

TransformFile = Annotated[
    Path,
    typer.Argument(
        metavar="TRANSFORM", help="A result's transform.json, or an ITK transform file: .tfm, .txt, .h5."
    ),
]
ImageFile = Annotated[Path, typer.Argument(metavar="IMAGE", help="The image to bring over.")]
Like = Annotated[Path, typer.Option("--like", "-l", help="Image whose grid is wanted: the fixed one.")]
Out = Annotated[Path, typer.Option("--out", "-o", help="File to write.")]
InterpolatorName = Annotated[
    str, typer.Option("--interpolator", "-i", help="See regframe list interpolators.")
]
Fill = Annotated[float, typer.Option(help="What pixels outside the image get.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Overwrite the file.")]


def apply(
    transform: TransformFile,
    image: ImageFile,
    like: Like,
    out: Out,
    interpolator: InterpolatorName = "bspline",
    fill: Fill = 0.0,
    plugin: Plugins = None,
    force: Force = False,
) -> None:
    """Resample IMAGE on the grid of another one through TRANSFORM, at its own depth and colour."""
    from regframe.catalog import INTERPOLATORS
    from regframe.cli import inputs
    from regframe.engine.resampling import align
    from regframe.errors import GeometryError
    from regframe.io import refuse_existing, write

    plugin_files.use(plugin)
    refuse_existing(out, force)
    way = INTERPOLATORS.build(interpolator)
    for path, role in ((transform, "transform"), (image, "image"), (like, "image given by --like")):
        inputs.existing(path, role)
    grid = inputs.image(like, "fixed").grid
    warp = inputs.transform(transform, grid)
    moving = inputs.image(image, "moving")
    if moving.dim != grid.dim:
        message = (
            f"{moving.name} is {moving.dim}-D and {like.name} is {grid.dim}-D. Both must have equal axes."
        )
        raise GeometryError(message)
    write(align(moving, grid, warp, way, fill), grid, out, force=force)
    typer.echo(f"wrote {out}")
