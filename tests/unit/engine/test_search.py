"""The search for a start: far motions, bounds, masks, metrics of any kind, either role, any thread count."""

import numpy as np
import pytest

import regframe
from regframe.engine.averaging import Pyramid
from regframe.engine.candidate import Place
from regframe.engine.overlap import shares
from regframe.engine.search import search, within
from regframe.engine.setting import Setting
from regframe.geometry import AffineMap, Frame, Grid
from regframe.image import Image
from regframe.metrics.base import Metric, Pairs
from regframe.metrics.oriented_gradients import OrientedGradients
from regframe.preset import Search, parse
from regframe.testing.phantoms import corner_error, visual_thermal
from regframe.transforms.linear import about, turn
from regframe.transforms.similarity import Similarity
from regframe.transforms.warp import Warp

FAST = {"type": "search", "size": 64, "step": 6.0, "keep": [6, 2]}
STAGE = {
    "start": FAST,
    "transform": "similarity",
    "interpolator": "linear",
    "metric": {"type": "oriented-gradients", "inner": 0.7, "outer": 1.0},
    "optimizer": "bfgs",
    "levels": [{"fit": 80, "iterations": 8}, {"fit": 160, "iterations": 12}, {"fit": 320, "iterations": 12}],
}


def preset(**changes):
    return parse({"name": "search", "stages": [STAGE | changes]})


def moved(image, matrix, shift, shape, mode="nearest"):
    """The image seen through a map from new pixels to its own, and the way back as a warp."""
    from scipy import ndimage

    middle, centre = (np.array(image.shape) - 1) / 2, (np.array(shape) - 1) / 2
    swapped = matrix[::-1, ::-1]
    offset = middle + np.array(shift)[::-1] - swapped @ centre
    return ndimage.affine_transform(image, swapped, offset, shape, order=1, mode=mode)


@pytest.fixture(scope="module")
def street():
    return visual_thermal(seed=3, shape=(240, 320))


def far_pair(street, angle_deg, scale, shift):
    """The thermal frame aligned with the visual one, then seen through a known far motion."""
    aligned = regframe.align(street.moving, street.fixed.grid, street.truth)
    matrix = scale * turn(np.deg2rad(angle_deg))
    moving = moved(aligned.astype(float), matrix, shift, aligned.shape)
    seen = moved(np.ones(aligned.shape), matrix, shift, aligned.shape, mode="constant")
    fixed, grid = street.fixed, street.fixed.grid
    to_aligned = about(matrix, np.array(shift, float), grid.centre)
    frame = Frame.about_centre(grid)
    return (
        fixed,
        Image.of_array(moving).with_mask(seen > 0.99),
        Warp(Similarity(), Similarity().from_affine(to_aligned.inverse(), frame), frame),
    )


@pytest.mark.parametrize(
    ("angle_deg", "scale", "shift"),
    [
        (25.0, 1.0, (0.0, 0.0)),
        (-20.0, 0.75, (20.0, -10.0)),
        (10.0, 1.3, (-30.0, 15.0)),
        (0.0, 1.0, (90.0, 40.0)),
    ],
)
def test_finds_far_motions(street, angle_deg, scale, shift):
    fixed, moving, truth = far_pair(street, angle_deg, scale, shift)

    result = regframe.register(preset(), fixed, moving)

    assert corner_error(result.warp, truth, fixed.grid) < 1.0


def test_finds_the_same_from_the_other_side(street):
    fixed, moving, truth = far_pair(street, 15.0, 0.8, (15.0, 5.0))

    result = regframe.register(preset(), moving, fixed)

    assert corner_error(result.warp.inverse(), truth, fixed.grid) < 2.5


def test_tells_what_it_tried(street):
    result = regframe.register(preset(), street.fixed, street.moving)

    assert len(result.candidates) == FAST["keep"][0]
    assert [len(one.values) for one in result.candidates] == [3, 2, 1, 1, 1, 1]
    best = result.candidates[0]
    assert best.values[-1] == result.value
    assert corner_error(best.found, result.warp, street.fixed.grid) == 0.0
    assert all(0.5 <= one.overlap <= 1.01 for one in result.candidates)
    assert [level.places for level in result.levels] == [*FAST["keep"], 1]
    # Of a level's evaluations each place has a part, the one that ended best among them.
    first, last = result.levels[0], result.levels[-1]
    assert first.other_evaluations > first.evaluations > 0
    assert last.other_evaluations == 0
    assert result.evaluations > sum(level.evaluations for level in result.levels)


def test_candidates_lie_apart(street):
    result = regframe.register(preset(), street.fixed, street.moving)

    seen = [one.seen for one in result.candidates]
    assert (
        min(corner_error(a, b, street.fixed.grid) for i, a in enumerate(seen) for b in seen[:i])
        > 6.0 * 320 / 64 * 0.5
    )


def test_the_thread_count_changes_nothing(street, monkeypatch):
    matrices = []
    for threads in ("1", "3"):
        monkeypatch.setenv("REGFRAME_THREADS", threads)
        matrices.append(regframe.register(preset(), street.fixed, street.moving).pixel_matrix)

    np.testing.assert_array_equal(*matrices)


def test_bounds_are_kept(street):
    stage = preset(start={**FAST, "rotation_deg": 3.0, "scale": [0.95, 1.05], "shift": 0.05}).stages[0]
    images = Pyramid(street.fixed, street.moving)

    found = search(stage, images, Setting(street.fixed.grid))

    ratio = street.moving.grid.extent[0] / street.fixed.grid.extent[0]
    for one in found:
        matrix = one.seen.as_affine().matrix
        assert abs(np.rad2deg(np.arctan2(matrix[1, 0], matrix[0, 0]))) <= 3.0 + 1e-9
        assert 0.95 - 1e-9 <= np.sqrt(np.linalg.det(matrix)) / ratio <= 1.05 + 1e-9


def test_a_masked_part_has_no_say(street):
    mask = np.ones(street.fixed.grid.shape, bool)
    mask[:, :90] = False
    spoilt = np.asarray(street.fixed.values).copy()
    spoilt[:, :90] = np.random.default_rng(1).uniform(0, 255, spoilt[:, :90].shape)
    pair = [street.fixed.with_values(values).with_mask(mask) for values in (street.fixed.values, spoilt)]

    first, second = (regframe.register(preset(), fixed, street.moving) for fixed in pair)

    np.testing.assert_array_equal(first.pixel_matrix, second.pixel_matrix)
    assert corner_error(first.warp, street.truth, street.fixed.grid) < 3.0


def test_known_fields_of_view_narrow_the_scale(street):
    fixed, moving, truth = far_pair(street, 0.0, 0.7, (0.0, 0.0))
    # Scale 0.7 from moving to aligned pixels: the moving frame sees 0.7 of the fixed one's width.
    wide = 80.0
    narrow = float(2 * np.rad2deg(np.arctan(0.7 * np.tan(np.deg2rad(wide / 2)))))
    start = {**FAST, "scale": [0.97, 1.03], "fields_of_view_deg": [wide, narrow]}

    result = regframe.register(preset(start=start), fixed, moving)

    assert corner_error(result.warp, truth, fixed.grid) < 2.5


class Difference(Metric):
    """Mean absolute difference: a metric of a user's, with nothing but a value."""

    def value(self, pairs: Pairs) -> float:
        """Infinite without weight."""
        mass = float(pairs.weight.sum())
        return float(np.sum(pairs.weight * abs(pairs.fixed - pairs.moving))) / mass if mass else float("inf")


def test_any_metric_can_be_searched_with(street):
    fixed = street.fixed
    moving = Image.of_array(
        moved(np.asarray(fixed.values, float), turn(0.2), (40.0, -20.0), fixed.grid.shape)
    )
    truth = about(turn(0.2), np.array([40.0, -20.0]), fixed.grid.centre).inverse()
    stage = preset(start={**FAST, "size": 24, "step": 4.0, "scale": [1.0, 1.0]}, transform="rigid").stages[0]

    found = search(
        stage.model_copy(update={"metric": Difference()}), Pyramid(fixed, moving), Setting(fixed.grid)
    )

    frame = Frame.about_centre(fixed.grid)
    wanted = Warp(Similarity(), Similarity().from_affine(truth, frame), frame)
    # Two of the search's points, which are 14 pixels apart.
    assert min(corner_error(one.seen, wanted, fixed.grid) for one in found[:2]) < 28.0


def test_volumes_are_refused():
    grid = Grid.of_shape((20, 20, 20))
    image = Image(np.random.default_rng(1).random(grid.shape), grid)

    with pytest.raises(regframe.GeometryError, match="2-D"):
        regframe.register(preset(), image, image)


def test_too_much_overlap_is_told():
    noise = np.random.default_rng(1).random((40, 100))
    start = {**FAST, "overlap": 0.9, "shift": 0.1, "relative_to": "spacing"}

    with pytest.raises(regframe.NoOverlapError, match="overlap"):
        regframe.register(preset(start=start, transform="translation"), noise, noise.T.copy())


def test_shift_of_a_grid_point_is_a_shift_of_the_warp():
    rng = np.random.default_rng(5)
    texture = rng.random((64, 64))
    image = Image.of_array(texture)
    start = {**FAST, "rotation_deg": 0.0, "scale": [1.0, 1.0], "size": 64}
    rolled = Image.of_array(np.roll(texture, (5, -3), axis=(0, 1)))
    stage = preset(start=start, transform="translation").stages[0]

    best = search(stage, Pyramid(image, rolled), Setting(image.grid))[0].seen.as_affine()

    assert isinstance(best, AffineMap)
    np.testing.assert_allclose(best.offset, [-3.0, 5.0], atol=1e-9)


@pytest.mark.parametrize(
    ("scale", "angle_deg", "inside"),
    [(1.0, 0.0, True), (1.75, 31.0, True), (2.1, 0.0, False), (0.4, 0.0, False), (1.0, -40.0, False)],
)
def test_a_place_may_stray_a_step_beyond_the_bounds_and_no_further(scale, angle_deg, inside):
    options = Search(scale=(0.6, 1.7), rotation_deg=30.0, size=150, step=10.0)
    fixed, moving = Grid.of_shape((60, 80)), Grid.of_shape((120, 160))
    affine = about(2.0 * scale * turn(np.deg2rad(angle_deg)), np.zeros(2), fixed.centre)

    assert within(options, Warp.of_affine(affine, Frame.about_centre(fixed)), fixed, moving) == inside


def test_places_rank_by_bounds_value_and_points_met():
    warp = Warp.of_affine(AffineMap.identity(2), Frame.about_centre(Grid.of_shape((8, 8))))
    metric = OrientedGradients()
    near = Place(warp, warp).walked(warp, -0.40).met_anew((1.0, 1.0), within=True)
    small = Place(warp, warp).walked(warp, -0.42).met_anew((1.0, 0.3), within=True)
    scant = Place(warp, warp).walked(warp, -0.42).met_anew((0.5, 0.5), within=True)
    beyond = Place(warp, warp).walked(warp, -0.90).met_anew((1.0, 1.0), within=False)

    ranked = sorted([beyond, scant, small, near], key=lambda place: place.rank(metric))

    assert ranked == [near, small, scant, beyond]


def test_what_both_frames_show():
    fixed, moving = Grid.of_shape((60, 80)), Grid.of_shape((60, 80))
    half = Warp.of_affine(AffineMap(np.eye(2), np.array([40.0, 0.0])), Frame.about_centre(fixed))
    twice = Warp.of_affine(about(2.0 * np.eye(2), np.zeros(2), fixed.centre), Frame.about_centre(fixed))

    assert shares(half, fixed, moving) == pytest.approx((0.5, 0.5), abs=0.03)
    # The moving frame shows a quarter of the fixed one, and all of itself.
    assert shares(twice, fixed, moving) == pytest.approx((1.0, 0.25), abs=0.03)
