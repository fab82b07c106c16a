import json

import numpy as np
import pytest
from scipy import ndimage

from regframe import PresetError, load_preset, register
from regframe.engine.keeping import chosen
from regframe.geometry import Frame, Grid
from regframe.image import Image
from regframe.report import html, records
from regframe.transforms.projective import Projective
from regframe.transforms.similarity import Similarity
from regframe.transforms.warp import Warp

GRID = Grid.of_shape((120, 160))
FRAME = Frame.about_centre(GRID, GRID)
PRESET = {
    "name": "chained",
    "stages": [
        {
            "start": "centres",
            "transform": family,
            "interpolator": "linear",
            "metric": "mean-squares",
            "optimizer": {"type": "lbfgsb", "convergence_factor": 1e10},
            "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 30}],
        }
        for family in ("similarity", "projective")
    ],
}
PRESET["stages"][1] |= {"start": "previous", "proof": 2.0}


def pair(truth, noise):
    """A texture, and the same seen through the truth with noise of its own."""
    rng = np.random.default_rng(3)
    texture = ndimage.gaussian_filter(rng.standard_normal((200, 240)), 3.0)
    texture *= 100 / texture.std()
    there = truth.inverse()(GRID.points(GRID.all_indices()))
    moving = ndimage.map_coordinates(texture, there.T[::-1] + 40.0, order=3).reshape(GRID.shape)
    fixed = texture[40:160, 40:200]
    return Image.of_array(fixed), Image.of_array(moving + noise * rng.standard_normal(GRID.shape))


@pytest.fixture(scope="module")
def bent():
    truth = Warp(Projective(), np.array([1.02, 0.01, -0.01, 1.0, 1.0, -0.5, 0.06, -0.04]), FRAME)
    return truth, register(PRESET, *pair(truth, 20.0))


@pytest.fixture(scope="module")
def straight():
    truth = Warp(Similarity(), np.array([1.02, 0.01, 1.0, -0.5]), FRAME)
    return truth, register(PRESET, *pair(truth, 100.0))


def test_a_homography_that_is_there_is_kept(bent):
    truth, result = bent

    assert isinstance(result.warp.transform, Projective)
    assert result.choices[0].kept
    assert np.abs(result.warp(GRID.corners()) - truth(GRID.corners())).max() < 0.5


def test_a_homography_that_only_fits_noise_is_not_kept(straight):
    truth, result = straight

    assert isinstance(result.warp.transform, Similarity)
    assert not result.choices[0].kept
    assert np.abs(result.warp(GRID.corners()) - truth(GRID.corners())).max() < 0.5


def test_the_value_is_that_of_the_map_that_was_kept(bent, straight):
    for result, level in ((bent[1], 1), (straight[1], 0)):
        assert result.value == result.levels[level].value
        assert result.stop == result.levels[level].stop


def test_the_choice_is_told(bent, straight):
    assert dict(html.facts(bent[1]))["stage 2"].startswith("projective kept: held-out gain")
    assert dict(html.facts(straight[1]))["stage 2"].startswith("projective not kept:")
    record = json.loads(records.to_json(records.result_record(bent[1])))
    assert record["choices"][0]["kept"] is True
    assert "tiles" in record["choices"][0]["reason"]


def test_too_few_tiles_prove_nothing():
    choice = chosen(1, np.full(5, 1.0), 2.0)

    assert not choice.kept
    assert "only 5 tiles" in choice.reason


def test_a_gain_in_few_tiles_is_not_enough():
    gains = np.array([-0.01] * 20 + [1.0] * 10)

    assert gains.mean() > 2.0 * gains.std() / np.sqrt(30)
    assert not chosen(1, gains, 2.0).kept


def test_a_slight_majority_of_tiles_is_not_enough():
    gains = np.array([-0.005] * 19 + [0.03] * 29)

    assert gains.mean() > 3.0 * gains.std() / np.sqrt(48)
    assert not chosen(1, gains, 3.0).kept
    assert chosen(1, np.array([-0.005] * 6 + [0.03] * 42), 3.0).kept


def test_below_0_a_map_stays_unless_it_is_clearly_worse():
    worse = np.array([-0.01] * 20 + [0.02] * 5)

    assert chosen(1, worse, -5.0).kept
    assert not chosen(1, worse - 0.05, -5.0).kept


def test_proof_needs_a_stage_before():
    with pytest.raises(PresetError, match=r"stages\.0\.proof: compares with the stage before"):
        load_preset("paper-similarity", {"stages.0.proof": 2.0})


def test_same_choice_at_any_number_of_threads(monkeypatch, bent):
    monkeypatch.setenv("REGFRAME_THREADS", "1")

    alone = register(PRESET, *pair(bent[0], 20.0))

    assert alone.choices == bent[1].choices
