"""Small components to register in tests."""

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from regframe.filters.base import Filter
from regframe.image import Image
from regframe.metrics.base import Metric, Pairs


class Stub(Metric):
    """A metric with options of several kinds."""

    bins: int = Field(50, ge=5, description="How many.")
    pair: tuple[float, float] = Field((0.0, 1.0), description="Two numbers.")
    mode: Literal["soft", "hard"] = Field("soft", description="One of two words.")
    limit: float | None = Field(None, description="A number, or none.")

    @model_validator(mode="after")
    def _ordered(self) -> "Stub":
        if self.pair[0] > self.pair[1]:
            message = f"`pair` must rise. Got {self.pair}. Write the smaller first."
            raise ValueError(message)
        return self

    def value(self, pairs: Pairs) -> float:
        return 0.0


class GridStub(Stub):
    """A metric that needs neighbourhoods."""

    layout: ClassVar[Literal["points", "grid"]] = "grid"


class Plain(Metric):
    """A metric without options."""

    def value(self, pairs: Pairs) -> float:
        return 0.0


class Same(Filter):
    """A filter that changes nothing."""

    amount: float = Field(0.0, description="Of nothing.")

    def __call__(self, image: Image) -> Image:
        return image
