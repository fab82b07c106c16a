"""Every registered component passes the public suite, with no list to maintain."""

import pytest

from regframe.catalog import FILTERS, INTERPOLATORS, METRICS, OPTIMIZERS, TRANSFORMS
from regframe.testing.checks import conformance

# Only components that cannot be built without options need one set of them here.
OPTIONS = {
    "window": {"low": 20.0, "high": 80.0},
    "sum": {"parts": ["mattes", "correlation"], "weights": [1.0, 0.5]},
}
# Settings that run other code than the defaults do.
VARIANTS = [(INTERPOLATORS, {"type": "bspline", "order": order}) for order in (0, 1, 2, 4, 5)] + [
    *((INTERPOLATORS, {"type": "windowed-sinc", "window": w}) for w in ("welch", "lanczos", "blackman")),
    (TRANSFORMS, {"type": "projective-radial", "fixed_coefficients": 2, "moving_coefficients": 2}),
    (TRANSFORMS, {"type": "projective-radial", "fixed_coefficients": 1, "moving_coefficients": 0}),
    (TRANSFORMS, {"type": "rigid", "order": "zyx"}),
    (METRICS, {"type": "ants-correlation", "radius": 1}),
    (METRICS, {"type": "joint-histogram-mi", "bins": 40, "variance": 0.0}),
    (METRICS, {"type": "local-correlation", "contrast": "same", "sigma": 2.0}),
    (METRICS, {"type": "local-correlation", "contrast": "inverted"}),
    (METRICS, {"type": "mattes", "bins": 12}),
    (METRICS, {"type": "mind-ssc", "reach": 1, "patch": 1.5}),
    (METRICS, {"type": "sum", "parts": ["ants-correlation", "mean-squares"], "weights": [30.0, 0.01]}),
    (METRICS, {"type": "sum", "parts": ["joint-histogram-mi", {"type": "mattes", "bins": 20}]}),
    (OPTIMIZERS, {"type": "conjugate-gradient-line-search", "estimate_learning_rate": "never"}),
    (OPTIMIZERS, {"type": "gradient-descent", "estimate_learning_rate": "each-iteration"}),
    (OPTIMIZERS, {"type": "lbfgsb", "lower": -9.0, "upper": 9.0}),
    (OPTIMIZERS, {"type": "multi-start", "optimizer": "lbfgsb", "starts": 5}),
    (OPTIMIZERS, {"type": "nelder-mead", "bound": 12.0, "restarts": 0}),
    (OPTIMIZERS, {"type": "one-plus-one", "variates": "numpy", "radius": 1.0}),
    (OPTIMIZERS, {"type": "regular-step-gradient-descent", "estimate_learning_rate": "once"}),
]


def shipped(registry):
    return [registry.build({"type": name, **OPTIONS.get(name, {})}) for name in registry.names()]


test_metric = conformance(*shipped(METRICS))
test_transform = conformance(*shipped(TRANSFORMS))
test_interpolator = conformance(*shipped(INTERPOLATORS))
test_optimizer = conformance(*shipped(OPTIMIZERS))
test_filter = conformance(*shipped(FILTERS))
test_variant = conformance(*(registry.build(config) for registry, config in VARIANTS))


@pytest.mark.parametrize(
    "registry", [METRICS, TRANSFORMS, INTERPOLATORS, OPTIMIZERS, FILTERS], ids=lambda r: r.kind
)
def test_every_registered_name_is_checked(registry):
    built = {registry.name_of(component) for component in shipped(registry)}

    assert built == set(registry.names())
