"""The five registries and what regframe ships in each: data, sorted; nothing is imported."""

from typing import TYPE_CHECKING

from regframe.errors import PresetError
from regframe.faults import nearest
from regframe.registry import AnyRegistry, Registry

if TYPE_CHECKING:
    from regframe.filters.base import Filter
    from regframe.interpolators.base import Interpolator
    from regframe.metrics.base import Metric
    from regframe.optimizers.base import Optimizer
    from regframe.transforms.base import Transform

METRICS: "Registry[Metric]" = Registry(
    "metric",
    "regframe.metrics.base:Metric",
    {
        "ants-correlation": "regframe.metrics.ants_correlation:AntsCorrelation",
        "correlation": "regframe.metrics.correlation:Correlation",
        "demons": "regframe.metrics.demons:Demons",
        "itk-joint-histogram-mi": "regframe.metrics.itk_joint_histogram_mi:ItkJointHistogramMi",
        "joint-histogram-mi": "regframe.metrics.joint_histogram_mi:JointHistogramMi",
        "local-correlation": "regframe.metrics.local_correlation:LocalCorrelation",
        "mattes": "regframe.metrics.mattes:Mattes",
        "mean-squares": "regframe.metrics.mean_squares:MeanSquares",
        "mind-ssc": "regframe.metrics.mind_ssc:MindSsc",
        "normalised-gradient-fields": (
            "regframe.metrics.normalised_gradient_fields:NormalisedGradientFields"
        ),
        "normalised-mi": "regframe.metrics.normalised_mi:NormalisedMi",
        "oriented-gradients": "regframe.metrics.oriented_gradients:OrientedGradients",
        "sum": "regframe.metrics.sum:Sum",
    },
)

TRANSFORMS: "Registry[Transform]" = Registry(
    "transform",
    "regframe.transforms.base:Transform",
    {
        "affine": "regframe.transforms.affine:Affine",
        "bspline": "regframe.transforms.bspline:BSpline",
        "displacement-field": "regframe.transforms.displacement_field:DisplacementField",
        "projective": "regframe.transforms.projective:Projective",
        "projective-radial": "regframe.transforms.projective_radial:ProjectiveRadial",
        "rigid": "regframe.transforms.rigid:Rigid",
        "scale": "regframe.transforms.scale:Scale",
        "scale-skew-versor": "regframe.transforms.scale_skew_versor:ScaleSkewVersor",
        "scale-versor": "regframe.transforms.scale_versor:ScaleVersor",
        "similarity": "regframe.transforms.similarity:Similarity",
        "translation": "regframe.transforms.translation:Translation",
        "versor": "regframe.transforms.versor:Versor",
        "versor-rigid": "regframe.transforms.versor_rigid:VersorRigid",
    },
)

INTERPOLATORS: "Registry[Interpolator]" = Registry(
    "interpolator",
    "regframe.interpolators.base:Interpolator",
    {
        "bspline": "regframe.interpolators.bspline:BSpline",
        "gaussian": "regframe.interpolators.gaussian:Gaussian",
        "label-gaussian": "regframe.interpolators.label_gaussian:LabelGaussian",
        "linear": "regframe.interpolators.linear:Linear",
        "nearest": "regframe.interpolators.nearest:Nearest",
        "windowed-sinc": "regframe.interpolators.windowed_sinc:WindowedSinc",
    },
)

OPTIMIZERS: "Registry[Optimizer]" = Registry(
    "optimizer",
    "regframe.optimizers.base:Optimizer",
    {
        "amoeba": "regframe.optimizers.amoeba:Amoeba",
        "bfgs": "regframe.optimizers.bfgs:Bfgs",
        "conjugate-gradient-line-search": (
            "regframe.optimizers.conjugate_gradient_line_search:ConjugateGradientLineSearch"
        ),
        "exhaustive": "regframe.optimizers.exhaustive:Exhaustive",
        "gradient-descent": "regframe.optimizers.gradient_descent:GradientDescent",
        "gradient-descent-line-search": (
            "regframe.optimizers.gradient_descent_line_search:GradientDescentLineSearch"
        ),
        "lbfgsb": "regframe.optimizers.lbfgsb:Lbfgsb",
        "multi-start": "regframe.optimizers.multi_start:MultiStart",
        "nelder-mead": "regframe.optimizers.nelder_mead:NelderMead",
        "one-plus-one": "regframe.optimizers.one_plus_one:OnePlusOne",
        "powell": "regframe.optimizers.powell:Powell",
        "regular-step-gradient-descent": (
            "regframe.optimizers.regular_step_gradient_descent:RegularStepGradientDescent"
        ),
    },
)

FILTERS: "Registry[Filter]" = Registry(
    "filter",
    "regframe.filters.base:Filter",
    {
        "clahe": "regframe.filters.clahe:Clahe",
        "equalize": "regframe.filters.equalize:Equalize",
        "gaussian": "regframe.filters.gaussian:Gaussian",
        "gradient-magnitude": "regframe.filters.gradient_magnitude:GradientMagnitude",
        "grey": "regframe.filters.grey:Grey",
        "invert": "regframe.filters.invert:Invert",
        "percentile-clip": "regframe.filters.percentile_clip:PercentileClip",
        "window": "regframe.filters.window:Window",
    },
)

KINDS: dict[str, AnyRegistry] = {
    "metrics": METRICS,
    "transforms": TRANSFORMS,
    "interpolators": INTERPOLATORS,
    "optimizers": OPTIMIZERS,
    "filters": FILTERS,
}


def of_kind(word: str) -> AnyRegistry:
    """The registry of a kind, named in the singular or the plural.

    Raises
    ------
    PresetError
        There is no such kind.

    Examples
    --------
    >>> of_kind("metric") is of_kind("metrics") is METRICS
    True
    """
    known = {registry.kind: registry for registry in KINDS.values()}
    found = {**KINDS, **known}.get(word)
    if found is None:
        message = f"there is no kind {word!r}.{nearest(word, known)} Known: {', '.join(known)}."
        raise PresetError(message)
    return found
