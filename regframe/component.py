"""What metrics, transforms, interpolators, optimizers and filters have in common."""

from abc import ABC

from pydantic import BaseModel, ConfigDict


class Component(BaseModel, ABC):
    """Frozen data with behaviour: its fields are its configuration, nothing on it ever changes.

    Fields are validated when the component is built, and unknown ones are refused. Whatever must be
    remembered during a run lives in local variables of the engine or of a generator.
    """

    # "constants": an infinite option is dumped as infinity, not as None.
    model_config = ConfigDict(
        frozen=True, extra="forbid", use_attribute_docstrings=False, ser_json_inf_nan="constants"
    )
