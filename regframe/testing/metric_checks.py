"""What every metric must hold."""

import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pickle import dumps, loads

import numpy as np

from regframe.metrics.base import Metric, Pairs
from regframe.testing.claims import NotApplicable, require, require_close, unchanged
from regframe.testing.phantoms import Modality, smooth_pair
from regframe.types import Values

SHAPE = (40, 44)
ROUNDING = 1e-9  # relative; sums of a few thousand terms in another order differ by 1e-13
KINDS: dict[str, Modality] = {"mono": "mono", "inverted": "inverted", "multimodal": "multimodal"}

Change = Callable[[Values, tuple[float, float]], Values]
CHANGES: dict[str, Change] = {
    "shift": lambda values, _: values + 1234.5,
    "scale": lambda values, _: 3.7 * values,
    "inversion": lambda values, ends: ends[0] + ends[1] - values,
    "monotone": lambda values, ends: np.expm1(2.0 * (values - ends[0]) / (ends[1] - ends[0])),
}
"""What `invariant_to` may name, as changes of the moving intensities; the last rises along a curve."""


def example_pairs(kind: Modality = "mono", shift: tuple[int, int] = (0, 0), *, seed: int = 1) -> Pairs:
    """Pairs of a smooth phantom as a level would build them, the moving image off by whole pixels.

    Weights are 0 where the shifted moving image ends and in a random tenth of the samples. The metric
    under test still has to prepare them, see `prepared`.

    Examples
    --------
    >>> pairs = example_pairs("inverted", (0, 3))
    >>> len(pairs.fixed) == len(pairs.moving) == 40 * 44
    True
    """
    phantom = smooth_pair(kind, SHAPE, seed=seed)
    rolled = np.roll(np.asarray(phantom.moving.values, np.float64), shift, axis=(0, 1))
    weight = (np.random.default_rng((seed, 4)).random(SHAPE) > 0.1).astype(np.float64)
    down, across = shift
    weight[: max(down, 0)] = 0.0
    weight[SHAPE[0] + min(down, 0) :] = 0.0
    weight[:, : max(across, 0)] = 0.0
    weight[:, SHAPE[1] + min(across, 0) :] = 0.0
    fixed = np.asarray(phantom.fixed.values, np.float64)
    return Pairs(
        fixed.ravel(), rolled.ravel(), weight.ravel(), phantom.fixed.range(), phantom.moving.range(), SHAPE
    )


def prepared(metric: Metric, pairs: Pairs) -> Pairs:
    """The pairs after `Metric.prepare`, which has not seen the moving intensities."""
    unseen = replace(pairs, moving=np.zeros(0), prepared=None)
    return replace(pairs, prepared=metric.prepare(unseen))


def check_ignores_weightless_samples(metric: Metric) -> None:
    """Samples of weight 0 have no say, whatever their intensities."""
    pairs = example_pairs()
    away = pairs.weight == 0.0
    rng = np.random.default_rng(5)
    for low, high in (pairs.moving_range, (-1e6, 1e6)):
        garbage = rng.uniform(low, high, (2, len(away)))
        other = replace(
            pairs,
            fixed=np.where(away, garbage[0], pairs.fixed),
            moving=np.where(away, garbage[1], pairs.moving),
        )
        _same_value(
            metric, pairs, other, "The value changes with the intensities of samples whose weight is 0."
        )
        _same_slopes(metric, pairs, other, "`derivative` changes with intensities whose weight is 0.")


def check_counts_only_weighted_samples(metric: Metric) -> None:
    """Leaving weightless samples out is the same as keeping them (layout "points")."""
    _needs_points(metric)
    pairs = example_pairs()
    kept = np.flatnonzero(pairs.weight)
    _same_value(metric, pairs, _picked(pairs, kept), "The value counts samples whose weight is 0.")


def check_weight_scale_does_not_matter(metric: Metric) -> None:
    """Weights are relative: all of them times 3 is the same."""
    pairs = example_pairs()
    heavier = replace(pairs, weight=3.0 * pairs.weight)
    _same_value(metric, pairs, heavier, "The value changes when all weights are multiplied by 3.")


def check_sample_order_does_not_matter(metric: Metric) -> None:
    """Samples may come in any order (layout "points")."""
    _needs_points(metric)
    pairs = example_pairs()
    order = np.random.default_rng(6).permutation(len(pairs.fixed))
    _same_value(metric, pairs, _picked(pairs, order), "The value depends on the order of the samples.")


def check_is_deterministic(metric: Metric) -> None:
    """The same pairs give the same bits, from this object and from a copy of it."""
    pairs = prepared(metric, example_pairs())
    first = metric.value(pairs)
    again = [metric.value(pairs), metric.value(pairs)]
    require(again == [first, first], f"Two calls with the same pairs differ: {first!r}, then {again!r}.")
    copy: Metric = loads(dumps(metric))
    other = copy.value(prepared(copy, example_pairs()))
    require(other == first, f"A copy of the metric gives another value: {other!r} for {first!r}.")


def check_is_thread_safe(metric: Metric) -> None:
    """Calls from several threads, on several pairs, give the values of one thread."""
    work = [prepared(metric, example_pairs(shift=(0, k))) for k in range(4)] * 4
    alone = [metric.value(pairs) for pairs in work]
    patience = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)  # threads take turns often, so that a race shows
    try:
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(metric.value, work))
    finally:
        sys.setswitchinterval(patience)
    require(
        together == alone,
        f"Values differ when four threads share the metric: {together[:4]} for {alone[:4]}. "
        "Keep state in local variables, not on the metric.",
    )


def check_leaves_its_input_alone(metric: Metric) -> None:
    """`prepare`, `value` and `derivative` write into none of the arrays they are given."""
    pairs = prepared(metric, example_pairs())
    names = ("fixed", "moving", "weight")
    before = {name: np.array(getattr(pairs, name)) for name in names}
    for step, call in (("value", metric.value), ("derivative", metric.derivative)):
        call(pairs)
        touched = [name for name in names if not unchanged(before[name], getattr(pairs, name))]
        require(not touched, f"`{step}` writes into pairs.{', pairs.'.join(touched)}. Copy before changing.")


def check_gives_a_float(metric: Metric) -> None:
    """The value is one real number."""
    value = metric.value(prepared(metric, example_pairs()))
    require(isinstance(value, float), f"`value` must return a float. Got {type(value).__name__}: {value!r}.")
    require(np.isfinite(value), f"`value` of two overlapping images must be finite. Got {value!r}.")


def check_prefers_alignment(metric: Metric) -> None:
    """Aligned images score lower than shifted ones, in every modality that `suits` names."""
    unknown = sorted(set(metric.suits) - set(KINDS))
    require(not unknown, f"`suits` may name {', '.join(KINDS)}. Got {', '.join(unknown)}.")
    require(bool(metric.suits), "`suits` is empty: name at least one of " + ", ".join(KINDS) + ".")
    for kind in metric.suits:
        aligned = metric.value(prepared(metric, example_pairs(KINDS[kind])))
        for shift in ((0, 2), (2, 0), (0, -5), (-5, 0), (4, 4)):
            moved = metric.value(prepared(metric, example_pairs(KINDS[kind], shift)))
            require(
                aligned < moved,
                f"On a {kind} pair, aligned images score {aligned:.6g} and images shifted by {shift} px "
                f"{moved:.6g}; lower must mean better. Flip the sign, or leave {kind!r} out of `suits`.",
            )


def check_derivative_matches_differences(metric: Metric) -> None:
    """`derivative` is the slope of `value` by the moving intensities, at fixed weights."""
    pairs = prepared(metric, example_pairs(KINDS[metric.suits[0]], (0, 2)))
    slopes = _slopes(metric, pairs)
    low, high = pairs.moving_range
    margin, step = 0.05 * (high - low), 1e-6 * (high - low)
    # A sample that crosses the range's end is a jump for some metrics, so those near it stay put.
    movable = (pairs.weight > 0.0) & (pairs.moving > low + margin) & (pairs.moving < high - margin)
    rng = np.random.default_rng(7)
    for share in (1.0, 1.0, 0.05):
        direction = rng.standard_normal(len(movable)) * (movable & (rng.random(len(movable)) < share))
        ahead, behind = (
            metric.value(replace(pairs, moving=pairs.moving + side * step * direction)) for side in (1, -1)
        )
        terms = slopes * direction
        # Rounding of the two values, and a thousandth for the curvature between them.
        noise = 1e-13 * max(1.0, abs(ahead)) / step
        scale = max(float(np.sqrt(np.sum(terms * terms))), abs(ahead - behind) / (2 * step))
        require_close(
            np.array(terms.sum()),
            np.array((ahead - behind) / (2 * step)),
            within=1e-3 * scale + noise,
            fault="`derivative` is not the slope of `value`: d value / d moving, uphill, a number a sample.",
        )


def check_holds_its_invariances(metric: Metric) -> None:
    """The value stays when moving intensities change in a way that `invariant_to` names."""
    unknown = sorted(set(metric.invariant_to) - set(CHANGES))
    require(not unknown, f"`invariant_to` may name {', '.join(CHANGES)}. Got {', '.join(unknown)}.")
    if not metric.invariant_to:
        message = "the metric declares no invariance (`invariant_to`)"
        raise NotApplicable(message)
    for kind in metric.suits:
        pairs = example_pairs(KINDS[kind], (0, 2))
        for name in metric.invariant_to:
            low, high = (
                float(CHANGES[name](np.array([end]), pairs.moving_range)[0]) for end in pairs.moving_range
            )
            changed = replace(
                pairs,
                moving=CHANGES[name](pairs.moving, pairs.moving_range),
                moving_range=(min(low, high), max(low, high)),
            )
            value, other = (metric.value(prepared(metric, each)) for each in (pairs, changed))
            require_close(
                np.array(other),
                np.array(value),
                within=1e-6 * max(1e-3, abs(value)),
                fault=f"`invariant_to` names {name!r}, but on a {kind} pair the value changes.",
            )


def check_forces_spare_weightless_samples(metric: Metric) -> None:
    """`forces`, where a metric has them, are one finite vector a sample, and 0 where the weight is 0."""
    if type(metric).forces is Metric.forces:
        message = "the metric leaves forces to the slope of its value"
        raise NotApplicable(message)
    pairs = prepared(metric, example_pairs(shift=(0, 2)))
    slopes = np.random.default_rng(8).normal(size=(len(pairs.fixed), 2))
    forces = metric.forces(pairs, slopes, (1.0, 1.0))
    require(
        forces is not None and forces.shape == slopes.shape and bool(np.isfinite(forces).all()),
        f"`forces` must give finite float64 of shape {slopes.shape}.",
    )
    away = pairs.weight == 0.0
    require(forces is not None and not forces[away].any(), "`forces` must be 0 where the weight is 0.")


def check_carried_features_stand_for_the_image(metric: Metric) -> None:
    """What `carried` gives has about the metric's value where nothing moves, and a slope of its own value."""
    if type(metric).carried is Metric.carried:
        message = "the metric has no features that a map could carry"
        raise NotApplicable(message)
    pairs = prepared(metric, example_pairs(KINDS[metric.suits[0]], (0, 2)))
    made = metric.carried(pairs, pairs.moving.reshape(SHAPE), pairs.weight.reshape(SHAPE))
    require(made is not None, "`carried` must give features of 2-D images. Got None.")
    assert made is not None  # for the type checker
    still, moved = np.eye(2, 3), np.array([[1.001, 0.0021, 0.337], [-0.0017, 0.9987, -0.271]])
    value = metric.value(pairs)
    require_close(
        np.array(made.value(still)),
        np.array(value),
        within=0.05 * max(1.0, abs(value)),
        fault="Where the map moves nothing, carried features give another value than the metric.",
    )
    slope, steps = made.value_and_slope(moved)[1], np.eye(6).reshape(6, 2, 3)
    # A fiftieth of a grid point, at the far end of the grid for what turns and grows.
    reach = 0.02 / np.array([SHAPE[0], SHAPE[1], 1.0, SHAPE[0], SHAPE[1], 1.0])
    rises = [
        (made.value(moved + length * step) - made.value(moved - length * step)) / 2
        for length, step in zip(reach, steps, strict=True)
    ]
    # Weights are held in a slope and change in a difference, so that they agree in about the direction.
    told = slope.ravel() * reach
    require(
        float(told @ rises) > 0.9 * float(np.linalg.norm(told) * np.linalg.norm(rises)),
        "The slope of carried features is not that of their value: d value / d map, (dim, dim + 1), uphill.",
    )


def check_survives_constant_images(metric: Metric) -> None:
    """Flat images raise nothing and never look like a good match."""
    pairs = example_pairs()
    flat, level = np.full_like(pairs.fixed, 7.0), (7.0, 7.0)
    cases = {
        "fixed": replace(pairs, fixed=flat, fixed_range=level),
        "moving": replace(pairs, moving=flat, moving_range=level),
        "part of the moving": replace(pairs, moving=np.full_like(flat, float(pairs.moving.mean()))),
    }
    text = f"{type(metric).__doc__} {type(metric).value.__doc__}".lower()
    for name, case in cases.items():
        value = _survived(metric, case, f"a constant {name} image")
        documented = (np.isposinf(value) and "infin" in text) or (np.isnan(value) and "nan" in text)
        require(
            np.isfinite(value) or documented,
            f"A constant {name} image gives {value!r}. Return a finite number, or say in the docstring of "
            "the metric or of `value` that it is infinite (or NaN) then.",
        )


def check_survives_no_overlap(metric: Metric) -> None:
    """Without any weight nothing is raised, and no finite value pretends that images were compared."""
    pairs = example_pairs()
    value = _survived(metric, replace(pairs, weight=np.zeros_like(pairs.weight)), "weights that are all 0")
    require(
        np.isposinf(value) or np.isnan(value),
        f"Weights that are all 0 give {value!r}. Return infinity: there was nothing to compare.",
    )


CHECKS = (
    check_gives_a_float,
    check_ignores_weightless_samples,
    check_counts_only_weighted_samples,
    check_weight_scale_does_not_matter,
    check_sample_order_does_not_matter,
    check_is_deterministic,
    check_is_thread_safe,
    check_leaves_its_input_alone,
    check_prefers_alignment,
    check_derivative_matches_differences,
    check_holds_its_invariances,
    check_forces_spare_weightless_samples,
    check_carried_features_stand_for_the_image,
    check_survives_constant_images,
    check_survives_no_overlap,
)


def _needs_points(metric: Metric) -> None:
    if metric.layout != "points":
        message = 'the metric asks for whole grids (layout "grid")'
        raise NotApplicable(message)


def _picked(pairs: Pairs, kept: "np.ndarray[tuple[int], np.dtype[np.int64]]") -> Pairs:
    return replace(
        pairs, fixed=pairs.fixed[kept], moving=pairs.moving[kept], weight=pairs.weight[kept], shape=None
    )


def _same_value(metric: Metric, one: Pairs, other: Pairs, fault: str) -> None:
    first, second = (metric.value(prepared(metric, pairs)) for pairs in (one, other))
    require_close(np.array(second), np.array(first), within=ROUNDING * max(1e-3, abs(first)), fault=fault)


def _same_slopes(metric: Metric, one: Pairs, other: Pairs, fault: str) -> None:
    if metric.derivative(prepared(metric, one)) is None:
        return
    first, second = (_slopes(metric, prepared(metric, pairs)) for pairs in (one, other))
    require_close(second, first, within=ROUNDING * float(np.abs(first).max()), fault=fault)
    require(not first[one.weight == 0.0].any(), "`derivative` must be 0 where the weight is 0.")


def _slopes(metric: Metric, pairs: Pairs) -> Values:
    slopes = metric.derivative(pairs)
    if slopes is None:
        message = "the metric leaves its slope to the engine's differences"
        raise NotApplicable(message)
    require(
        slopes.shape == pairs.moving.shape and slopes.dtype == np.float64,
        f"`derivative` must give float64 of shape {pairs.moving.shape}. Got {slopes.dtype} {slopes.shape}.",
    )
    return slopes


def _survived(metric: Metric, pairs: Pairs, what: str) -> float:
    try:
        with np.errstate(all="ignore"):
            ready = prepared(metric, pairs)
            metric.derivative(ready)
            return float(metric.value(ready))
    except Exception as error:
        # Whatever the author's code raises here, the run it would end is a fault of the metric.
        message = f"{type(error).__name__} is raised by {what}: {error}. Return infinity instead."
        raise AssertionError(message) from error
