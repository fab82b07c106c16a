"""SimpleITK's errors in our words."""

import pytest

from regframe.errors import ImageError, NoOverlapError, RegframeError
from regframe.peer.faults import translated

HEAD = "Exception thrown in SimpleITK ImageRegistrationMethod_Execute: /a/b.hxx:12:\nITK ERROR: M(0x5f): "


@pytest.mark.parametrize(
    ("told", "kind"),
    [
        ("All samples map outside moving image buffer.", NoOverlapError),
        ("A zero-valued spacing is not supported.", ImageError),
        ("something else.\nand more.", RegframeError),
    ],
)
def test_becomes_one_line_of_the_right_kind(told, kind):
    error = translated(RuntimeError(HEAD + told))

    assert type(error) is kind
    assert "\n" not in str(error)
    assert "0x" not in str(error)
    assert "hxx" not in str(error)
