"""Free-form deformation."""

import numpy as np
import pytest

from regframe.engine.scales import coordinates
from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.preset import Stage
from regframe.transforms.bspline import BSpline
from regframe.transforms.lattice import lattice

GRID = Grid((12, 16), (0.5, 0.75), (-3.0, 7.0), ((0.8, -0.6), (0.6, 0.8)))
FRAME = Frame.about_centre(GRID)
SPACE = Frame.about_centre(Grid.of_shape((6, 7, 8)))
both_orders = pytest.mark.parametrize("order", [2, 3])


def naive_map(params, c, order, shape):
    """Displacement at one lattice index, by the recursion of Cox and de Boor."""

    def weight(u, degree):
        if degree == 0:
            return 1.0 if -0.5 <= u < 0.5 else 0.0
        half = (degree + 1) / 2
        return ((half + u) * weight(u + 0.5, degree - 1) + (half - u) * weight(u - 0.5, degree - 1)) / degree

    along_y, along_x = ([weight(at - k, order) for k in range(n)] for at, n in zip(c, shape, strict=True))
    return [np.array(along_y) @ one @ np.array(along_x) for one in params.reshape(2, *shape)]


@both_orders
def test_has_one_coefficient_a_control_point_and_axis(order):
    family = BSpline(mesh=(3, 5), order=order)

    assert len(family.identity(FRAME)) == 2 * (3 + order) * (5 + order)
    assert family.names(FRAME)[1] == "x[1,0]"


def test_one_number_counts_for_all_axes():
    assert np.array_equal(BSpline(mesh=(3,)).identity(SPACE), BSpline(mesh=(3, 3, 3)).identity(SPACE))


def test_refuses_a_mesh_of_other_dimensions():
    with pytest.raises(GeometryError, match="3 numbers and the image 2 axes"):
        BSpline(mesh=(3, 3, 3)).identity(FRAME)


@both_orders
def test_displaces_by_splines(order):
    family, control = BSpline(mesh=(3, 5), order=order), lattice(GRID, (3, 5), order)
    params = np.random.default_rng(1).normal(size=len(family.identity(FRAME)))
    points = GRID.points(np.random.default_rng(2).uniform(0.0, 11.0, (20, 2)))

    moved = family.map(params, points, FRAME) - points

    wanted = [naive_map(params, c, order, control.shape) for c in control.indices(points)]
    np.testing.assert_allclose(moved, wanted, rtol=0, atol=1e-12)


def test_points_beyond_the_image_stay():
    points = GRID.points(np.array([[-1.0, 3.0], [3.0, 16.0], [40.0, 40.0]]))
    params = np.ones_like(BSpline().identity(FRAME))

    assert np.array_equal(BSpline().map(params, points, FRAME), points)


@both_orders
def test_takes_over_an_affine_map_within_the_image(order):
    family = BSpline(mesh=(2, 3), order=order)
    affine = AffineMap(np.array([[1.1, -0.2], [0.3, 0.9]]), np.array([5.0, -7.0]))
    points = GRID.points(GRID.all_indices())

    found = family.map(family.from_affine(affine, FRAME), points, FRAME)

    np.testing.assert_allclose(found, affine(points), rtol=0, atol=1e-12)


@pytest.mark.parametrize("frame", [FRAME, SPACE], ids=["plane", "space"])
def test_shift_is_the_largest_weight_on_the_grid(frame):
    family = BSpline(mesh=(2,))
    points = frame.grid.points(frame.grid.all_indices())
    nothing = family.identity(frame)

    wanted = [
        np.linalg.norm(family.map(unit, points, frame) - points, axis=1).max()
        for unit in np.eye(len(nothing))
    ]

    # The lattice's direction is single precision, so its axes are not quite the grid's.
    np.testing.assert_allclose(family.shift(nothing, frame), wanted, rtol=1e-5)


def test_slopes_reach_the_support_alone():
    family = BSpline(mesh=(8, 8))
    point, force = GRID.points(np.array([[3.3, 4.4]])), np.array([[1.0, 0.0]])

    slopes = family.parameter_gradient(family.identity(FRAME), point, force, FRAME)

    assert np.count_nonzero(slopes) == 16
    assert slopes.sum() == pytest.approx(1.0)


def test_scales_by_jacobian_tell_what_lies_out_of_sight():
    """ITK looks at a block of 11 points an axis in the middle of the grid."""
    grid = Grid.of_shape((60, 60))
    frame, family = Frame.about_centre(grid), BSpline(mesh=(12,))
    stage = Stage(
        transform=family, interpolator="linear", metric="mattes", optimizer="one-plus-one", scales="jacobian"
    )

    with pytest.raises(GeometryError, match="parameters move nothing where 'jacobian' looks"):
        coordinates(stage, family.identity(frame), frame, grid, grid)
