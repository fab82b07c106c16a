"""What the shipped presets promise."""

import pytest

from regframe.preset import Preset, differences, load

SIMILARITY = load("paper-similarity")
AFFINE = load("paper-affine")


def changed(a: Preset, b: Preset) -> dict[str, object]:
    """New values by path, but for name and about."""
    return {path: new for path, _, new in differences(a, b) if path not in ("name", "about", "stages.0.name")}


def test_the_paper_uses_its_own_numbers():
    stage = SIMILARITY.stages[0]

    assert (stage.metric.bins, stage.interpolator.order) == (50, 3)
    assert (stage.optimizer.growth, stage.optimizer.epsilon) == (1.05, 1.5e-4)
    assert [(level.shrink, level.iterations, level.sampling) for level in stage.levels] == [(1, 300, "all")]


def test_the_affine_of_the_paper_changes_the_map_and_the_radius():
    assert changed(SIMILARITY, AFFINE) == {
        "stages.0.transform": {"type": "affine"},
        "stages.0.optimizer.radius": 1.0,
    }


@pytest.mark.parametrize("base", [SIMILARITY, AFFINE], ids=lambda base: base.name)
def test_a_pyramid_changes_only_the_levels(base):
    pyramid = load(f"{base.name}-pyramid")

    levels = [(level.shrink, level.smooth, level.iterations) for level in pyramid.stages[0].levels]

    assert levels == [(4, 2.0, 300), (2, 1.0, 300), (1, 0.0, 300)]
    assert {path.split(".")[2] for path in changed(base, pyramid)} == {"levels"}


@pytest.mark.parametrize("family", ["similarity", "affine"])
def test_the_radius_of_matlab_moves_by_pixels(family):
    stage = load(f"matlab-multimodal-{family}").stages[0]

    first = [stage.optimizer.radius / scale for scale in stage.scales]

    assert first[-2:] == pytest.approx([6.25, 6.25])
    assert first[:-2] == pytest.approx([6.25e-3] * (len(first) - 2))


def test_matlab_uses_its_own_numbers():
    stage = load("matlab-multimodal-similarity").stages[0]

    assert (stage.optimizer.growth, stage.optimizer.epsilon, stage.metric.bins) == (1.05, 1.5e-6, 50)
    assert [level.iterations for level in stage.levels] == [100, 100, 100]
