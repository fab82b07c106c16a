"""The cross-check on real frames."""

import pytest

from regframe.peer.crosscheck import crosscheck


@pytest.mark.slow
def test_everything_agrees_on_a_road_scene(data):
    scene = data / "visual_thermal" / "roadscene"

    report = crosscheck(
        "paper-similarity", scene / "visual" / "FLIR_00060.jpg", scene / "thermal" / "FLIR_00060.jpg"
    )

    assert [line for line in report.lines if line.verdict != "agrees"] == []
    assert report.corner < 1e-6
