"""Fits the coefficients of the verdict, and says how well they hold on scenes that were kept back."""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray
from runs import Row
from scipy import optimize, stats

from regframe.verdict.calibration import FAILED, GOOD, NAMES, features

SIGNS = {"parts_near": 1, "edge_fit": 1, "leftover": -1, "rival": -1, "round_trip": -1}
"""Which way each kind of evidence may speak; a fit against that would be an accident of the table."""
RIDGE = 0.3
SMALLEST_PX, LARGEST_PX = 0.25, 256.0
BINS = 10

Coefficients = NDArray[np.float64]


def everything(rows: Sequence[Row]) -> dict[str, dict[str, dict[str, float]]]:
    """The coefficients from all rows, with and without a second search, by name."""
    kinds = {"with_round_trip": searched(rows), "without_round_trip": unsearched(rows)}
    return {
        kind: {"probability": _named(probability(part)), "log2_error": _named(log2_error(part))}
        for kind, part in kinds.items()
    }


def searched(rows: Sequence[Row]) -> list[Row]:
    """The rows of runs with a second search."""
    return [row for row in rows if row.evidence.round_trip_px is not None]


def unsearched(rows: Sequence[Row]) -> list[Row]:
    """All rows as if no second search had been made."""
    return [replace(row, evidence=replace(row.evidence, round_trip_px=None)) for row in rows]


def write(fitted: dict[str, dict[str, dict[str, float]]]) -> None:
    """Put the coefficients where the package reads them."""
    place = files("regframe.verdict").joinpath("coefficients.json")
    with open(str(place), "w", encoding="utf-8") as file:  # noqa: PTH123, a resource is a path here
        file.write(json.dumps(fitted, indent=2) + "\n")


def probability(rows: Sequence[Row]) -> Coefficients:
    """Logistic regression with signs and a ridge, for being near."""
    seen, near = _seen(rows), np.array([row.near for row in rows], float)
    scale = _scale(seen)

    def loss(at: Coefficients) -> tuple[float, Coefficients]:
        logit = seen @ at
        value = np.logaddexp(0.0, logit).sum() - near @ logit + 0.5 * RIDGE * ((at * scale) ** 2).sum()
        slope = seen.T @ (1.0 / (1.0 + np.exp(-logit)) - near) + RIDGE * at * scale**2
        return float(value), slope

    return _fitted(loss, seen.shape[1])


def log2_error(rows: Sequence[Row]) -> Coefficients:
    """Least squares with signs and a ridge, for the logarithm of the error where that is known."""
    known = [row for row in rows if row.error_px is not None]
    seen = _seen(known)
    error = np.log2(np.clip([row.error_px for row in known], SMALLEST_PX, LARGEST_PX))
    scale = _scale(seen)

    def loss(at: Coefficients) -> tuple[float, Coefficients]:
        left = seen @ at - error
        return float(
            left @ left + RIDGE * ((at * scale) ** 2).sum()
        ) / 2, seen.T @ left + RIDGE * at * scale**2

    return _fitted(loss, seen.shape[1], turned=True)


def _seen(rows: Sequence[Row]) -> NDArray[np.float64]:
    return np.array([features(row.evidence) for row in rows])


def _scale(seen: NDArray[np.float64]) -> Coefficients:
    """Spread of each kind of evidence, so that the ridge is fair; the constant is free."""
    return np.where(np.arange(seen.shape[1]) > 0, seen.std(axis=0), 0.0)


def _fitted(
    loss: Callable[[Coefficients], tuple[float, Coefficients]], count: int, *, turned: bool = False
) -> Coefficients:
    signs = [(-1 if turned else 1) * SIGNS.get(name, 0) for name in NAMES[:count]]
    bounds = [(0 if sign > 0 else None, 0 if sign < 0 else None) for sign in signs]
    options = {"maxiter": 5000, "maxfun": 50000, "ftol": 1e-14, "gtol": 1e-9}
    return optimize.minimize(
        loss, np.zeros(count), jac=True, method="L-BFGS-B", bounds=bounds, options=options
    ).x


def _named(at: Coefficients) -> dict[str, float]:
    return {name: round(float(value), 4) for name, value in zip(NAMES, at, strict=False)}


def kept_back(rows: Sequence[Row]) -> tuple[list[Row], NDArray[np.float64]]:
    """Each row whose scenes all lie in one half, and its probability as fitted to the other half."""
    scenes = sorted({name for row in rows for name in row.scenes})
    judged, chances = [], []
    for half in (0, 1):
        mine = {name for number, name in enumerate(scenes) if number % 2 == half}
        train = [row for row in rows if not mine & set(row.scenes)]
        test = [row for row in rows if mine >= set(row.scenes)]
        judged += test
        chances.append(_chances(test, probability(train)))
    return judged, np.concatenate(chances)


def _chances(rows: Sequence[Row], at: Coefficients) -> NDArray[np.float64]:
    return 1.0 / (1.0 + np.exp(-(_seen(rows) @ at)))


def auc(chances: NDArray[np.float64], near: NDArray[np.bool_]) -> float:
    """Area under the ROC curve: how often a near map gets a higher probability than a far one."""
    count, ranks = int(near.sum()), stats.rankdata(chances)
    return float((ranks[near].sum() - count * (count + 1) / 2) / (count * (len(near) - count)))


def calibration_error(chances: NDArray[np.float64], near: NDArray[np.bool_]) -> float:
    """Expected calibration error: distance of share and mean probability over ten bins, by their rows."""
    bins = np.minimum((chances * BINS).astype(int), BINS - 1)
    gaps = [
        abs(near[bins == one].mean() - chances[bins == one].mean()) * (bins == one).mean()
        for one in set(bins)
    ]
    return float(sum(gaps))


def report(rows: Sequence[Row]) -> str:
    """How well the fit holds on kept-back scenes, as a table, and by kind of case."""
    runs = [row for row in rows if row.kind != "displaced"]
    lines = [f"{len(runs)} runs, {sum(row.near for row in runs)} of them within 5 px"]
    for title, part in (("with a second search", searched(rows)), ("without", unsearched(rows))):
        judged, chances = kept_back(part)
        run = np.array([row.kind != "displaced" for row in judged])
        near = np.array([row.near for row in judged])
        lines += ["", f"{title}: {run.sum()} runs on kept-back scenes"]
        lines += _rates([row for row in judged if row.kind != "displaced"], chances[run], near[run])
        lines += [f"  and {(~run).sum()} of their maps pushed aside by 2 to 40 px"]
        lines += _rates(judged, chances, near)[:2]
    whole = searched(rows)
    lines += ["", "by kind, with a second search, all scenes fitted:"]
    return "\n".join([*lines, *_kinds(whole, _chances(whole, probability(whole)))]) + "\n"


def _rates(rows: Sequence[Row], chances: NDArray[np.float64], near: NDArray[np.bool_]) -> list[str]:
    wrong = np.array([row.kind == "wrong" for row in rows])
    far = ~near & ~wrong
    numbers = {
        "ROC AUC": f"{auc(chances, near):.4f}",
        "expected calibration error": f"{calibration_error(chances, near):.4f}",
        "near called good": _share(chances[near] >= GOOD),
        "near called failed": _share(chances[near] < FAILED),
        "wrong pairs called good": _share(chances[wrong] >= GOOD),
        "other far ones called good": _share(chances[far] >= GOOD),
        "far ones called failed": _share(chances[~near] < FAILED),
    }
    return [f"  {name:28} {text}" for name, text in numbers.items()]


def _share(claims: NDArray[np.bool_]) -> str:
    return f"{claims.mean():.4f} ({claims.sum()} of {len(claims)})" if len(claims) else "no such run"


def _kinds(rows: Sequence[Row], chances: NDArray[np.float64]) -> list[str]:
    near = np.array([row.near for row in rows])
    claims = (chances >= GOOD, (chances >= FAILED) & (chances < GOOD), chances < FAILED)
    head = "near: good/doubtful/failed"
    lines = [f"  {'kind':12} {'runs':>5} {'near':>5}  {head:28} {head.replace('near', 'far')}"]
    for kind in sorted({row.kind for row in rows}):
        mine = np.array([row.kind == kind for row in rows])
        words = ["/".join(str(int((one & mine & side).sum())) for one in claims) for side in (near, ~near)]
        lines.append(f"  {kind:12} {mine.sum():5} {(mine & near).sum():5}  {words[0]:28} {words[1]}")
    return lines
