"""What a preset holds: filters, stages, levels, and which combinations are possible."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_core import InitErrorDetails

from regframe.catalog import FILTERS, INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
from regframe.faults import fault, nearest, raised, shown
from regframe.filters.base import Filter
from regframe.interpolators.base import Interpolator
from regframe.metrics.base import Metric
from regframe.optimizers.base import Optimizer
from regframe.preset.record import Record
from regframe.preset.search import Search
from regframe.transforms.base import Transform

LARGEST_SEED = 2**32 - 1

Place = Literal[
    "centres",
    "identity",
    "moments",
    "principal-axes",
    "itk-principal-axes",
    "fields-of-view",
    "previous",
    "compose",
]
STARTS = (*get_args(Place), "search")
Estimator = Literal["shift", "grid-shift", "physical-shift", "index-shift", "jacobian"]
ESTIMATORS = get_args(Estimator)


def _check_scales(met: object) -> object:
    """One fault for the whole field, where a union of types would give one a type."""
    if isinstance(met, str) and met in ESTIMATORS:
        return met
    if isinstance(met, list | tuple) and met and all(_positive(scale) for scale in met):
        return tuple(map(float, met))
    near = nearest(met, ESTIMATORS) if isinstance(met, str) else ""
    names = ", ".join(map(repr, ESTIMATORS))
    message = f"must be {names} or a list of numbers above 0, one a parameter. Got {met!r}.{near}"
    raise ValueError(message)


def _positive(scale: object) -> bool:
    return isinstance(scale, int | float) and not isinstance(scale, bool) and 0 < scale < float("inf")


Scales = Annotated[Estimator | tuple[float, ...], BeforeValidator(_check_scales)]


def _check_start(met: object) -> object:
    """The word for a search becomes its table; one fault for the whole field."""
    if met == "search":
        return Search()
    if isinstance(met, Search) or (isinstance(met, dict) and met.get("type") == "search"):
        return met
    if isinstance(met, str) and met in STARTS:
        return met
    near = nearest(met, STARTS) if isinstance(met, str) else ""
    names = ", ".join(map(repr, STARTS))
    message = f'must be {names}, or a table with type = "search". Got {met!r}.{near}'
    raise ValueError(message)


Start = Annotated[Place | Search, BeforeValidator(_check_start)]


class Level(Record):
    """One resolution of a stage's pyramid."""

    shrink: int = Field(1, ge=1, strict=True, description="Take every n-th grid point along each axis.")
    fit: int | None = Field(
        None,
        ge=16,
        strict=True,
        description=(
            "In place of `shrink`: average both images over the whole number of pixels that leaves about "
            "this many along the longest axis."
        ),
    )
    smooth: float = Field(
        0.0, ge=0, strict=True, description="Sigma of the Gaussian on both images in pixels (or mm); 0: none."
    )
    iterations: int = Field(300, ge=1, strict=True, description="Most iterations of the optimizer.")
    optimizer: Annotated[Optimizer, OPTIMIZERS] | None = Field(
        None,
        description="In place of the stage's: a far-seeing one where the image is coarse, say.",
    )
    carried: bool = Field(
        False,
        description=(
            "Make the moving image's features once, where the level begins, and let maps carry them along; "
            "quick, and near enough for steps of a few grid points. For metrics that have such features."
        ),
    )
    sampling: Literal["all", "regular", "random"] = Field(
        "all", description="Which grid points are compared: all, every n-th one jittered, or drawn at random."
    )
    fraction: float = Field(
        1.0,
        strict=True,
        description="Share of the grid points compared when `sampling` is not `all`.",
        json_schema_extra={"exclusiveMinimum": 0, "maximum": 1},
    )

    refine: int | None = Field(
        None,
        ge=1,
        strict=True,
        description=(
            "Cells of a B-spline's mesh at this level, as a multiple of the transform's `mesh`; the new "
            "control points keep the motion found at them. None leaves the mesh as it is."
        ),
    )

    @property
    def resolution(self) -> str:
        """How coarse the level is, in the words of its field."""
        return f"shrink {self.shrink}" if self.fit is None else f"fit {self.fit}"

    @field_validator("fraction", mode="before")
    @classmethod
    def _check_fraction(cls, met: object) -> object:
        if isinstance(met, int | float) and not 0 < met <= 1:
            message = f"must be in (0, 1]. Got {met!r}. Write 0.2 for one sample in five."
            raise ValueError(message)
        return met

    @model_validator(mode="after")
    def _check_fit(self) -> Self:
        if self.fit is not None and self.shrink != 1:
            text = f"has no effect beside `fit`. Got {self.shrink!r}. Leave one of them out."
            raise raised([fault(("shrink",), text, self.shrink)])
        return self

    @model_validator(mode="after")
    def _check_sampling(self) -> Self:
        if self.sampling == "all" and self.fraction < 1:
            text = (
                f'has no effect with sampling "all". Got {self.fraction!r}. '
                'Write sampling = "random" or "regular", or fraction = 1.0.'
            )
            raise raised([fault(("fraction",), text, self.fraction)])
        return self


class Stage(Record):
    """One search: a family of maps, fitted on one level after the other."""

    name: str = Field("", description="What reports call the stage.")
    start: Start = Field(
        "centres",
        description=(
            "Where the search begins: image centres on each other, no motion, centres of mass, these and the "
            "axes of the intensities' spread (the smallest turn that lays one on the other; or ITK's turn, "
            "which does not, to repeat its results), equal fields of view (frames brought together by the "
            "ratio of their widths), the stage before, or a search over rotations, scales and shifts "
            "(`search`, or a table of its options); stages after the first "
            "continue with `previous` unless told otherwise. `compose` keeps the map found so far as it is, "
            "and looks for another one that is applied before it, from no motion."
        ),
    )
    transform: Annotated[Transform, TRANSFORMS] = Field(
        description="The family of maps to search in.", examples=["similarity"]
    )
    interpolator: Annotated[Interpolator, INTERPOLATORS] = Field(
        description="Values between pixels.", examples=["bspline"]
    )
    metric: Annotated[Metric, METRICS] = Field(
        description="How unlike the images are; lower is better.", examples=["mattes"]
    )
    optimizer: Annotated[Optimizer, OPTIMIZERS] = Field(
        description="How parameters are improved.", examples=["one-plus-one"]
    )
    scales: Scales = Field(
        "shift",
        description=(
            "The optimizer's unit: pixels (or mm) of motion (`shift`), points of the level's grid "
            "(`grid-shift`), one of ITK's estimators, or ITK's "
            "scales as a list, one number a parameter."
        ),
    )
    weights: tuple[Annotated[float, Field(ge=0, strict=True)], ...] | None = Field(
        None,
        description=(
            "Factors on the slope by each parameter, ITK's weights, for optimizers that walk along slopes; "
            "0 keeps a parameter as it is. All 1 unless given."
        ),
    )
    frozen: tuple[str, ...] = Field(
        (),
        description="Parameters that stay as the stage finds them, by names as `regframe explain` tells.",
    )
    smooth_unit: Literal["physical", "voxels"] = Field(
        "physical",
        description=("Unit of the levels' `smooth`: mm (or pixels of a camera), or each image's own voxels."),
    )
    gradient: Literal["exact", "filtered", "central"] = Field(
        "exact",
        description=(
            "Slope of the moving image: derivative of the interpolated image, ITK's smoothed gradient image "
            "(its default), or ITK's central differences."
        ),
    )
    proof: float | None = Field(
        None,
        strict=True,
        description=(
            "Standard errors by which the stage's map must be better than the map of the stage before, in "
            "tiles of the image that its fit did not see, to replace it; below 0 it stays unless it is so "
            "much worse. Not asked for unless given."
        ),
    )
    levels: tuple[Level, ...] = Field((Level(),), min_length=1, description="Run in the order listed.")

    @model_validator(mode="after")
    def _check_weights(self) -> Self:
        others = (level.optimizer for level in self.levels if level.optimizer is not None)
        useless = next((one for one in (self.optimizer, *others) if not one.weighs), None)
        if self.weights is None or useless is None:
            return self
        name = OPTIMIZERS.name_of(useless)
        text = (
            f"the optimizer {name!r} does not walk along slopes, so it has no use for weights. Got "
            f"{list(self.weights)!r}. Write frozen = [...] with the names of parameters that must stay."
        )
        raise raised([fault(("weights",), text, self.weights)])

    @model_validator(mode="after")
    def _check_refine(self) -> Self:
        if self.transform.refines or all(level.refine is None for level in self.levels):
            return self
        name = TRANSFORMS.name_of(self.transform)
        text = f"the transform {name!r} has no mesh to refine. Leave it out, or choose bspline."
        faults = [
            fault(("levels", i, "refine"), f"{text} Got {level.refine}.", level.refine)
            for i, level in enumerate(self.levels)
            if level.refine is not None
        ]
        raise raised(faults)

    @model_validator(mode="after")
    def _check_layout(self) -> Self:
        if self.metric.layout != "grid":
            return self
        name = METRICS.name_of(self.metric)
        faults = [
            fault(
                ("levels", i, "sampling"),
                f"the metric {name!r} needs neighbourhoods, so every grid point. "
                f'Got {level.sampling!r}. Write "all".',
                level.sampling,
            )
            for i, level in enumerate(self.levels)
            if level.sampling != "all"
        ]
        if faults:
            raise raised(faults)
        return self

    @model_validator(mode="after")
    def _check_carried(self) -> Self:
        able = type(self.metric).carried is not Metric.carried
        if able or not any(level.carried for level in self.levels):
            return self
        name = METRICS.name_of(self.metric)
        text = f"the metric {name!r} has no features that a map could carry. Leave it out, or write false."
        faults = [
            fault(("levels", i, "carried"), f"{text} Got true.", True)
            for i, level in enumerate(self.levels)
            if level.carried
        ]
        raise raised(faults)


class Filters(Record):
    """What is done to each image before anything else, in the order listed."""

    fixed: tuple[Annotated[Filter, FILTERS], ...] = Field((), description="Filters of the fixed image.")
    moving: tuple[Annotated[Filter, FILTERS], ...] = Field((), description="Filters of the moving image.")


class Preset(Record):
    """A whole registration, but for the two images."""

    name: str = Field("unnamed", min_length=1, description="What reports call the preset.")
    about: str = Field("", description="Where the values come from, and when to use them.")
    seed: int = Field(
        1, ge=1, le=LARGEST_SEED, strict=True, description="Of all random numbers; ITK takes 0 for the clock."
    )
    filters: Filters = Field(Filters(), description="Each image's own preparation.")
    stages: tuple[Stage, ...] = Field(min_length=1, description="Searches, each beginning where it is told.")

    @model_validator(mode="before")
    @classmethod
    def _refuse_code(cls, tree: object) -> object:
        """A preset may come from a stranger, so it names components and never code."""
        keys = [key for key in ("plugin", "plugins") if isinstance(tree, dict) and key in tree]
        if keys and isinstance(tree, dict):
            text = (
                f"a preset cannot load plugins: it may come from a stranger. Got {shown(tree[keys[0]])}. "
                "Remove it; name your own files with --plugin FILE, or in your configuration."
            )
            raise raised([fault((keys[0],), text, tree[keys[0]])])
        return tree

    @field_validator("stages")
    @classmethod
    def _chain(cls, stages: tuple[Stage, ...]) -> tuple[Stage, ...]:
        faults = list(_start_faults(stages))
        if faults:
            raise raised(faults)
        stages = (stages[0], *(_continued(stage) for stage in stages[1:]))
        faults = list(_proof_faults(stages))
        if faults:
            raise raised(faults)
        return stages


def _start_faults(stages: tuple[Stage, ...]) -> Iterator[InitErrorDetails]:
    first = stages[0].start
    if first in ("previous", "compose"):
        text = f'the first stage has none before it. Got {first!r}. Write "centres" or "fields-of-view".'
        yield fault((0, "start"), text, first)


def _proof_faults(stages: tuple[Stage, ...]) -> Iterator[InitErrorDetails]:
    for i, stage in enumerate(stages):
        if stage.proof is not None and stage.start != "previous":
            text = (
                f"compares with the stage before, from which this one does not begin. Got {stage.proof!r} "
                f'with start {shown(stage.start)}. Write start = "previous", or leave `proof` out.'
            )
            yield fault((i, "proof"), text, stage.proof)


def _continued(stage: Stage) -> Stage:
    return stage if "start" in stage.model_fields_set else stage.model_copy(update={"start": "previous"})


def dump(preset: Preset) -> dict[str, Any]:
    """The whole preset as tables, lists and values, every default written out."""
    return preset.model_dump(mode="json")
