"""Grids, frames and affine maps."""

import numpy as np
import pytest

from regframe.errors import GeometryError
from regframe.geometry import AffineMap, Frame, Grid

TURNED = ((0.8, -0.6), (0.6, 0.8))


def oblique():
    return Grid((3, 4), (2.0, 0.5), (10.0, -5.0), TURNED)


def test_camera_grid_has_pixel_units():
    grid = Grid.of_shape((480, 640))

    assert grid.spacing == (1.0, 1.0)
    assert grid.origin == (0.0, 0.0)
    assert grid.upright


def test_indices_are_array_order_and_points_x_first():
    grid = Grid.of_shape((480, 640))

    assert grid.points(np.array([[2.0, 7.0]])).tolist() == [[7.0, 2.0]]
    assert grid.indices(np.array([[7.0, 2.0]])).tolist() == [[2.0, 7.0]]


def test_volume_indices_run_z_y_x():
    grid = Grid((4, 5, 6), (0.5, 2.0, 3.0), (1.0, 1.0, 1.0), tuple(map(tuple, np.eye(3))))

    assert grid.points(np.array([[1.0, 2.0, 4.0]])).tolist() == [[3.0, 5.0, 4.0]]


def test_direction_columns_are_the_axes():
    grid = oblique()

    along_x, along_y = grid.points(np.array([[0.0, 1.0], [1.0, 0.0]])) - np.array(grid.origin)

    assert along_x == pytest.approx([1.6, 1.2])
    assert along_y == pytest.approx([-0.3, 0.4])


def test_index_to_point_agrees_with_points():
    grid = oblique()
    indices = grid.all_indices()

    assert np.allclose(grid.index_to_point(indices[:, ::-1]), grid.points(indices), atol=1e-13)


def test_point_to_index_agrees_with_indices():
    grid = oblique()
    points = grid.points(grid.all_indices())

    assert np.allclose(grid.point_to_index(points)[:, ::-1], grid.indices(points), atol=1e-13)


def test_zero_origin_leaves_no_negative_zero():
    assert not np.signbit(Grid.of_shape((5, 5)).point_to_index.offset).any()


def test_all_indices_run_along_x_fastest():
    assert Grid.of_shape((2, 3)).all_indices().tolist() == [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]


def test_corners_are_pixel_centres():
    assert Grid.of_shape((3, 5)).corners().tolist() == [[0, 0], [4, 0], [0, 2], [4, 2]]


def test_volume_has_eight_corners():
    assert len(Grid.of_shape((3, 4, 5)).corners()) == 8


@pytest.mark.parametrize(
    ("index", "claim"), [(-0.5, True), (-0.5000001, False), (2.4999999, True), (2.5, False), (np.nan, False)]
)
def test_inside_is_half_a_pixel_around(index, claim):
    grid = Grid.of_shape((3, 9))

    assert grid.inside(np.array([[index, 4.0]])).tolist() == [claim]


def test_size_counts_points():
    assert Grid.of_shape((3, 4, 5)).size == 60


def test_extent_reaches_outer_pixel_edges():
    assert oblique().extent.tolist() == [8.0, 1.5]


def test_coarsen_by_one_is_the_same_grid():
    grid = oblique()

    assert grid.coarsen(1) is grid


def test_coarsen_rounds_the_size_down():
    coarse = Grid.of_shape((9, 10)).coarsen(4)

    assert coarse.shape == (2, 2)
    assert coarse.spacing == (4.0, 4.0)
    assert coarse.centre.tolist() == [4.5, 4.0]


def test_coarsen_keeps_one_point_an_axis():
    assert Grid.of_shape((3, 100)).coarsen(8).shape == (1, 12)


def test_frame_turns_about_the_grids_centre():
    assert Frame.about_centre(Grid.of_shape((3, 5))).centre.tolist() == [2.0, 1.0]


def test_affine_map_applies_matrix_and_offset():
    affine = AffineMap(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([10.0, 20.0]))

    assert affine(np.array([[1.0, 1.0], [0.0, 2.0]])).tolist() == [[13.0, 27.0], [14.0, 28.0]]


def test_matmul_applies_the_right_one_first():
    shift = AffineMap(np.eye(2), np.array([1.0, 0.0]))
    double = AffineMap(2 * np.eye(2), np.zeros(2))

    assert (double @ shift)(np.array([[3.0, 0.0]])).tolist() == [[8.0, 0.0]]


def test_singular_map_has_no_inverse():
    flat = AffineMap(np.array([[1.0, 2.0], [2.0, 4.0]]), np.zeros(2))

    with pytest.raises(GeometryError, match=r"cannot be inverted.*singular"):
        flat.inverse()


def test_homogeneous_matrix_comes_back():
    affine = AffineMap(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([5.0, 6.0]))

    again = AffineMap.from_homogeneous(affine.homogeneous())

    assert affine.homogeneous().tolist() == [[1, 2, 5], [3, 4, 6], [0, 0, 1]]
    assert np.array_equal(again.matrix, affine.matrix)
    assert np.array_equal(again.offset, affine.offset)


def test_reversed_axes_is_the_same_map_of_reversed_points():
    affine = AffineMap(np.arange(9.0).reshape(3, 3), np.array([1.0, 2.0, 3.0]))
    points = np.array([[0.5, -1.0, 4.0]])

    assert np.allclose(affine.reversed_axes()(points[:, ::-1]), affine(points)[:, ::-1], atol=1e-13)


def test_identity_moves_nothing():
    points = np.array([[3.0, -4.0, 5.0]])

    assert AffineMap.identity(3)(points).tolist() == points.tolist()
    assert AffineMap.identity(3).dim == 3
