"""A street whose true map is known, and maps beside it."""

import pytest

from regframe.testing.phantoms import misalignment, visual_thermal


@pytest.fixture(scope="session")
def street():
    return visual_thermal(2, (240, 320))


@pytest.fixture(scope="session")
def beside(street):
    """Maps that depart from equal fields of view as told."""

    def at(**departure):
        return misalignment(street.fixed.grid, street.moving.grid, **departure)

    return at
