"""Several metrics as one."""

from dataclasses import replace
from typing import Annotated, Literal, Self, final

import numpy as np
from pydantic import Field, model_validator

from regframe.catalog import METRICS
from regframe.faults import fault, raised
from regframe.metrics.base import Metric, Pairs
from regframe.types import Values


@final
class Sum(Metric):
    """Weighted sum of other metrics, as itk::ObjectToObjectMultiMetricv4 makes it.

    Metrics differ in unit and in size, and so must their weights: `mattes` moves within about 1,
    `mean-squares` within squared grey levels. The sum wants whole grids if one of its parts does, and has a
    slope if all of them do; of the demons it takes the slope of their value. It is infinite where a part is.
    Departure from ITK: weights are not divided by their sum.
    """

    parts: tuple[Annotated[Metric, METRICS], ...] = Field(
        min_length=1,
        description="The metrics, each a name or a table.",
        examples=[["mattes", {"type": "mattes", "bins": 20}]],
    )
    weights: tuple[Annotated[float, Field(gt=0)], ...] = Field(
        (), description="What each part counts, in their order; without any, each counts 1."
    )

    @model_validator(mode="after")
    def _check_weights(self) -> Self:
        if self.weights and len(self.weights) != len(self.parts):
            text = (
                f"must be as many as the parts, {len(self.parts)}. Got {len(self.weights)}. "
                "Give one weight a part, or leave `weights` out."
            )
            raise raised([fault(("weights",), text, list(self.weights))])
        return self

    @property
    def layout(self) -> Literal["points", "grid"]:  # type: ignore[override]  # it is that of the parts
        """Grids if a part wants them."""
        return "grid" if any(part.layout == "grid" for part in self.parts) else "points"

    @property
    def suits(self) -> tuple[str, ...]:  # type: ignore[override]  # the same
        """What all parts suit."""
        return _common([part.suits for part in self.parts])

    @property
    def invariant_to(self) -> tuple[str, ...]:  # type: ignore[override]  # the same
        """What no part notices."""
        return _common([part.invariant_to for part in self.parts])

    def prepare(self, pairs: Pairs) -> tuple[object, ...]:
        """What each part prepares."""
        return tuple(part.prepare(pairs) for part in self.parts)

    def value(self, pairs: Pairs) -> float:
        """sum of weight * value of a part; infinite or NaN where one of them is."""
        return float(sum(weight * part.value(own) for part, weight, own in self._shares(pairs)))

    def derivative(self, pairs: Pairs) -> Values | None:
        """sum of weight * slope of a part, or None if a part has none."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values | None]:
        """Both, from one pass over the parts."""
        total, slopes = 0.0, np.zeros_like(pairs.moving)
        sloped = True
        for part, weight, own in self._shares(pairs):
            value, slope = part.value_and_derivative(own)
            total += weight * value
            if slope is None:
                sloped = False
            else:
                slopes += weight * slope
        return total, slopes if sloped else None

    def _shares(self, pairs: Pairs) -> list[tuple[Metric, float, Pairs]]:
        """Each part, its weight, and the pairs as the part prepared them."""
        prepared = pairs.prepared if isinstance(pairs.prepared, tuple) else self.prepare(pairs)
        weights = self.weights or (1.0,) * len(self.parts)
        return [
            (part, weight, replace(pairs, prepared=own))
            for part, weight, own in zip(self.parts, weights, prepared, strict=True)
        ]


def _common(claims: list[tuple[str, ...]]) -> tuple[str, ...]:
    """What all lists hold, in the order of the first."""
    return tuple(claim for claim in claims[0] if all(claim in others for others in claims))
