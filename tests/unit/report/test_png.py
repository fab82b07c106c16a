import numpy as np
import pytest

from regframe.io import read
from regframe.report.png import encode


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3), (1, 1), (1, 9, 3)])
def test_a_reader_gets_the_same_pixels(shape, tmp_path):
    picture = np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)

    (tmp_path / "picture.png").write_bytes(encode(picture))

    assert np.array_equal(np.squeeze(read(tmp_path / "picture.png").raw), np.squeeze(picture))


def test_views_that_are_not_contiguous_are_written_as_seen(tmp_path):
    picture = np.random.default_rng(1).integers(0, 256, (8, 8), dtype=np.uint8)

    (tmp_path / "picture.png").write_bytes(encode(picture[::2, ::-1]))

    assert np.array_equal(read(tmp_path / "picture.png").raw, picture[::2, ::-1])
