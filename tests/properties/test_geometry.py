"""Laws of grids and affine maps, for any geometry."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from properties.strategies import affine_maps, dimensions, grids, seeds

# Coordinates reach 1e3 mm, so rounding stays below this.
ROUNDING = 1e-9


def some_indices(grid, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-2.0, 2.0, (20, grid.dim)) + rng.uniform(0, 1, (20, grid.dim)) * np.array(grid.shape)


def some_points(dim, seed):
    return np.random.default_rng(seed).uniform(-100.0, 100.0, (20, dim))


@given(grids(), seeds)
def test_indices_undo_points(grid, seed):
    indices = some_indices(grid, seed)

    again = grid.indices(grid.points(indices))

    # An index is a distance over the spacing, at least 0.05 mm.
    np.testing.assert_allclose(again, indices, rtol=0, atol=ROUNDING)


@given(grids(), seeds)
def test_points_undo_indices(grid, seed):
    points = some_points(grid.dim, seed)

    np.testing.assert_allclose(grid.points(grid.indices(points)), points, rtol=0, atol=ROUNDING)


@given(grids(), seeds)
def test_steps_between_points_are_spacings(grid, seed):
    indices = some_indices(grid, seed)

    for axis in range(grid.dim):
        ahead = indices.copy()
        ahead[:, axis] += 1.0
        lengths = np.linalg.norm(grid.points(ahead) - grid.points(indices), axis=1)
        np.testing.assert_allclose(lengths, grid.spacing[grid.dim - 1 - axis], rtol=1e-9)


@given(grids())
def test_every_grid_point_is_inside(grid):
    assert grid.inside(grid.all_indices()).all()


@given(grids())
def test_centre_is_the_mean_of_the_corners(grid):
    np.testing.assert_allclose(grid.centre, grid.corners().mean(axis=0), rtol=0, atol=ROUNDING)


@given(grids(), st.integers(1, 12))
def test_coarsen_keeps_the_centre(grid, factor):
    np.testing.assert_allclose(grid.coarsen(factor).centre, grid.centre, rtol=0, atol=ROUNDING)


@given(grids(), st.integers(1, 12))
def test_coarsen_keeps_direction_and_multiplies_spacing(grid, factor):
    coarse = grid.coarsen(factor)

    assert coarse.direction == grid.direction
    np.testing.assert_allclose(coarse.spacing, factor * np.array(grid.spacing), rtol=1e-15)


@given(grids(), st.integers(1, 12))
def test_coarsen_stays_within_the_image(grid, factor):
    # Where an axis is shorter than the factor its one point is the middle, so this holds too.
    assert grid.inside(grid.indices(grid.coarsen(factor).corners())).all()


@given(st.data(), dimensions, seeds)
def test_composition_is_one_after_the_other(data, dim, seed):
    first, second = data.draw(affine_maps(dim)), data.draw(affine_maps(dim))
    points = some_points(dim, seed)

    np.testing.assert_allclose((second @ first)(points), second(first(points)), rtol=0, atol=ROUNDING)


@given(st.data(), dimensions, seeds)
def test_composition_is_associative(data, dim, seed):
    a, b, c = (data.draw(affine_maps(dim)) for _ in range(3))
    points = some_points(dim, seed)

    np.testing.assert_allclose(((a @ b) @ c)(points), (a @ (b @ c))(points), rtol=0, atol=1e-8)


@given(st.data(), dimensions, seeds)
def test_inverse_undoes_from_both_sides(data, dim, seed):
    affine = data.draw(affine_maps(dim))
    points = some_points(dim, seed)

    np.testing.assert_allclose((affine @ affine.inverse())(points), points, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose((affine.inverse() @ affine)(points), points, rtol=0, atol=ROUNDING)


@given(st.data(), dimensions)
def test_homogeneous_matrices_multiply_as_maps_compose(data, dim):
    first, second = data.draw(affine_maps(dim)), data.draw(affine_maps(dim))

    product = second.homogeneous() @ first.homogeneous()

    np.testing.assert_allclose((second @ first).homogeneous(), product, rtol=0, atol=ROUNDING)


@given(st.data(), dimensions)
def test_reversing_axes_twice_is_nothing(data, dim):
    affine = data.draw(affine_maps(dim))

    again = affine.reversed_axes().reversed_axes()

    assert np.array_equal(again.matrix, affine.matrix)
    assert np.array_equal(again.offset, affine.offset)


@given(st.data(), dimensions, seeds)
def test_reversing_axes_commutes_with_composition(data, dim, seed):
    first, second = data.draw(affine_maps(dim)), data.draw(affine_maps(dim))
    points = some_points(dim, seed)

    apart = second.reversed_axes() @ first.reversed_axes()

    np.testing.assert_allclose((second @ first).reversed_axes()(points), apart(points), rtol=0, atol=ROUNDING)
