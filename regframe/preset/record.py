"""What every table of a preset is."""

from pydantic import BaseModel, ConfigDict


class Record(BaseModel):
    """A frozen, closed table of a preset."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, ser_json_inf_nan="constants")
