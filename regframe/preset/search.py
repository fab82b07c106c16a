"""Options of `start = "search"`: where to look before the first level."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from regframe.preset.record import Record

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Angle = Annotated[float, Field(gt=0.0, lt=180.0)]


class Search(Record):
    """Every rotation, scale and shift within bounds, coarsely; the best few go on."""

    type: Literal["search"] = Field("search", description="The word that stands for the whole table.")
    rotation_deg: float = Field(
        30.0, ge=0.0, le=180.0, description="Largest rotation either way; 180 is all of them."
    )
    scale: tuple[float, float] = Field(
        (0.6, 1.7), description="Smallest and largest scale, relative to `relative_to`."
    )
    relative_to: Literal["fields-of-view", "spacing"] = Field(
        "fields-of-view",
        description="What scale 1 is: both frames equally wide, or one mm (or pixel) equal to one.",
    )
    shift: float = Field(
        0.4,
        ge=0.0,
        le=2.0,
        description="Largest distance of the two centres along each axis, as a share of the larger frame's.",
    )
    overlap: float = Field(
        0.5, gt=0.0, le=1.0, description="Least share of the smaller frame that lies within the larger."
    )
    keep: tuple[Annotated[int, Field(ge=1, le=100)], ...] = Field(
        (8, 3), min_length=1, description="Distinct places that go through the first level, the second ..."
    )
    size: int = Field(64, ge=16, le=512, description="Points, about, along the longest axis of its grid.")
    step: float = Field(
        4.0,
        gt=0.0,
        le=64.0,
        description="Points that corners move from one rotation, or scale, to the next.",
    )
    fields_of_view_deg: tuple[Angle, Angle] | None = Field(
        None, description="Widths of the fixed and the moving frame, if known: scale 1 then is what they say."
    )

    @model_validator(mode="after")
    def _bounds_fit(self) -> Self:
        low, high = self.scale
        if not 0.0 < low <= high:
            message = f"`scale` must be two factors above 0, the smaller first. Got {list(self.scale)}."
            raise ValueError(message)
        if tuple(sorted(self.keep, reverse=True)) != self.keep:
            message = f"`keep` must not grow from level to level. Got {list(self.keep)}."
            raise ValueError(message)
        if self.fields_of_view_deg is not None and self.relative_to != "fields-of-view":
            message = '`fields_of_view_deg` has no effect with relative_to "spacing". Leave one of them out.'
            raise ValueError(message)
        return self
