"""Everything that SimpleITK's registration method offers has a line on the page and a parity test."""

import ast
import re
from pathlib import Path

import pytest

from house.source import REPOSITORY

HERE = Path(__file__).parent
PAGE = REPOSITORY / "docs" / "explanation" / "agreement.md"

# What is offered: its lines on the page, and the tests that compare it.
OFFERED = {
    "mean squares": (["mean-squares"], ["test_other_metrics.py::test_value_and_valid_points"]),
    "correlation": (["correlation"], ["test_other_metrics.py::test_derivative_with_the_gradients_of_itk"]),
    "Mattes": (["mattes"], ["test_mattes.py::test_value_in_space", "test_mattes.py::test_value_under_masks"]),
    "joint histogram": (
        ["itk-joint-histogram-mi", "joint-histogram-mi"],
        [
            "test_joint_histogram.py::test_derivative_of_itk",
            "test_joint_histogram.py::test_true_marginals_give_a_mutual_information",
        ],
    ),
    "ANTS neighbourhood correlation": (
        ["ants-correlation"],
        ["test_ants_correlation.py::test_value_in_space"],
    ),
    "demons": (["demons"], ["test_demons.py::test_value_and_pushes"]),
    "translation": (["translation"], ["test_transforms.py::test_places_are_equal_to_the_last_bit"]),
    "Euler": (["rigid"], ["test_whole_runs.py::test_descent_of_rotations_in_space"]),
    "similarity": (["similarity"], ["test_whole_runs.py::test_evolution_of_rotations_in_space"]),
    "versor": (["versor"], ["test_transforms_in_space.py::test_too_long_versors_are_clipped_the_same"]),
    "versor-rigid": (["versor-rigid"], ["test_whole_runs.py::test_evolution_beyond_half_a_turn"]),
    "scale-versor": (
        ["scale-versor"],
        ["test_transforms_in_space.py::test_a_step_along_the_slope_ends_at_the_same_parameters"],
    ),
    "scale-skew-versor": (
        ["scale-skew-versor"],
        ["test_whole_runs.py::test_evolution_of_rotations_in_space"],
    ),
    "scale": (["scale"], ["test_transforms.py::test_points_go_to_the_same_places"]),
    "affine": (["affine"], ["test_transforms.py::test_the_matrix_is_the_same"]),
    "B-spline maps": (["bspline"], ["test_transforms_curved.py::test_descent_over_two_levels"]),
    "displacement field": (["displacement-field"], ["test_demons.py::test_value_and_pushes"]),
    "smoothed fields": (
        ["update_variance", "total_variance"],
        ["test_fields.py::test_steps_and_fields_are_smoothed_alike"],
    ),
    "refined meshes": (["bspline", "refine"], ["test_refined.py::test_both_engines_refine_alike"]),
    "composite": (
        ["moving_initial, chains", "compose"],
        [
            "test_transforms.py::test_their_composite_applies_the_last_one_first",
            "test_settings.py::test_a_composed_stage_keeps_the_map_before",
        ],
    ),
    "initial maps": (
        ["moving_initial, chains", "fixed_initial"],
        ["test_settings.py::test_both_engines_walk_alike"],
    ),
    "weights and frozen parameters": (
        ["weights, frozen"],
        [
            "test_weights.py::test_descents_weigh_slopes_alike",
            "test_weights.py::test_frozen_is_a_weight_of_zero",
        ],
    ),
    "interpolators": (
        ["nearest", "linear", "bspline", "gaussian", "label-gaussian", "windowed-sinc"],
        [
            "test_interpolators.py::test_values_at_any_position",
            "test_interpolators.py::test_resampled_images",
        ],
    ),
    "evolution": (["one-plus-one"], ["test_one_plus_one.py::test_walks_the_same_path"]),
    "gradient descent": (["gradient-descent"], ["test_descents.py::test_walks_the_same_path"]),
    "line search": (["gradient-descent-line-search"], ["test_descents.py::test_walks_the_same_path"]),
    "regular step": (
        ["regular-step-gradient-descent"],
        ["test_regular_step.py::test_walks_the_same_path"],
    ),
    "conjugate gradients": (
        ["conjugate-gradient-line-search"],
        ["test_descents.py::test_walks_the_same_path"],
    ),
    "Powell": (["powell"], ["test_direct_searches.py::test_powell_walks_the_same_path"]),
    "Amoeba": (["amoeba"], ["test_direct_searches.py::test_amoeba_walks_the_same_path"]),
    "exhaustive": (["exhaustive"], ["test_direct_searches.py::test_exhaustive_visits_the_same_positions"]),
    "L-BFGS-B": (["lbfgsb"], ["test_whole_runs.py::test_lbfgsb_ends_at_the_same_optimum"]),
    "convergence windows": (
        ["convergence_minimum, convergence_window"],
        ["test_descents.py::test_judges_convergence_by_the_same_number"],
    ),
    "learning rates": (
        ['estimate_learning_rate = "once"', 'estimate_learning_rate = "each-iteration"'],
        [
            "test_descents.py::test_estimates_the_same_learning_rates",
            "test_regular_step.py::test_estimates_the_same_learning_rates",
        ],
    ),
    "scales": (
        [
            "scales as a list",
            'scales = "physical-shift"',
            'scales = "index-shift"',
            'scales = "jacobian"',
        ],
        ["test_whole_runs.py::test_descent_with_estimated_scales"],
    ),
    "sampling and its seeds": (
        ['sampling = "regular"', 'sampling = "random"'],
        ["test_whole_runs.py::test_sparse_samples", "test_settings.py::test_sparse_samples_of_a_domain"],
    ),
    "masks": (["masks"], ["test_mattes.py::test_value_under_masks"]),
    "virtual domain": (["domain"], ["test_settings.py::test_both_engines_walk_alike"]),
    "shrink and smoothing": (
        ["shrink, smooth", 'smooth_unit = "voxels"'],
        ["test_gaussian.py::test_smooths_to_the_same_bits", "test_starts.py::test_smoothing_units"],
    ),
    "initialisers": (
        [
            'start = "centres"',
            'start = "moments"',
            'start = "principal-axes"',
            'start = "itk-principal-axes"',
        ],
        [
            "test_starts.py::test_itks_own_turn_is_found",
            "test_starts.py::test_moments_are_the_initialiser_without_rotation",
            "test_starts.py::test_principal_axes_are_theirs_but_not_the_turn",
        ],
    ),
    "gradients of the moving image": (
        ['gradient = "filtered"', 'gradient = "central"'],
        ["test_gaussian.py::test_has_the_same_gradient_image"],
    ),
    "oblique directions": (["oblique grids"], ["test_mattes.py::test_value_on_oblique_grids"]),
    "float32 images": (
        ["float32 images"],
        ["test_ants_correlation.py::test_value_of_single_precision_images"],
    ),
}


@pytest.fixture(scope="module")
def lines():
    return set(re.findall(r"^\| `(.+?)` \| ", PAGE.read_text(encoding="utf-8"), re.MULTILINE))


def functions_of(name):
    tree = ast.parse((HERE / name).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("what", OFFERED)
def test_has_a_line_and_a_test(what, lines):
    named, tests = OFFERED[what]

    assert named
    assert set(named) <= lines
    assert tests
    for place in tests:
        file, _, test = place.partition("::")
        assert test in functions_of(file), place
