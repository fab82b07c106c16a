import json

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.errors import GeometryError
from regframe.geometry import Frame, Grid
from regframe.transforms import files, json_files
from regframe.transforms.affine import Affine
from regframe.transforms.bspline import BSpline
from regframe.transforms.fields import displacement_field
from regframe.transforms.projective import Projective
from regframe.transforms.projective_radial import ProjectiveRadial
from regframe.transforms.rigid import Rigid
from regframe.transforms.warp import Warp

FIXED, MOVING = Grid.of_shape((96, 128)), Grid.of_shape((60, 100))
FRAME = Frame.about_centre(FIXED, MOVING)
PLANE = [0.7, 0.02, -0.03, 0.72, -14.0, -18.0, 0.06, -0.04]
WARPS = [
    Warp(Projective(), np.array(PLANE), FRAME),
    Warp(ProjectiveRadial(), np.array([*PLANE, -0.2]), FRAME),
    Warp(ProjectiveRadial(fixed_coefficients=1), np.array([*PLANE, 0.05, -0.2]), FRAME),
    Warp(ProjectiveRadial(fixed_coefficients=1, moving_coefficients=0), np.array([*PLANE, -0.1]), FRAME),
]
each = pytest.mark.parametrize("warp", WARPS, ids=lambda warp: f"{len(warp.params)} parameters")
AT = FIXED.points(FIXED.all_indices())


def test_the_centre_goes_where_the_shift_says():
    warp = WARPS[0]

    np.testing.assert_allclose(warp(FIXED.centre[None])[0], FIXED.centre + np.array([-14.0, -18.0]))


def test_without_perspective_it_is_the_affine_map_of_the_same_numbers():
    plain = np.array([*PLANE[:6], 0.0, 0.0])

    found, wanted = Projective().map(plain, AT, FRAME), Affine().map(plain[:6], AT, FRAME)

    np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_perspective_halves_lengths_where_the_depth_doubles():
    params = np.array([1.0, 0, 0, 1.0, 0, 0, 1.0, 0.0])
    right = FIXED.centre + np.array([FIXED.radius, 0.0])

    arm = Projective().map(params, right[None], FRAME)[0] - FIXED.centre

    np.testing.assert_allclose(arm, [FIXED.radius / 2, 0.0], atol=1e-12)


def test_a_barrel_lens_brings_corners_inwards():
    still = ProjectiveRadial().identity(Frame.about_centre(FIXED, FIXED))
    still[8] = -0.1
    corner = FIXED.corners()[:1]

    moved = ProjectiveRadial().map(still, corner, Frame.about_centre(FIXED, FIXED))

    near, far = (np.linalg.norm(one - FIXED.centre) for one in (moved, corner))
    assert 0.88 * far < near < 0.95 * far


def test_lenses_need_a_coefficient():
    with pytest.raises(ValueError, match="choose the transform `projective`"):
        ProjectiveRadial(moving_coefficients=0)


def test_lenses_bend_about_the_middle_of_their_own_image():
    warp = Warp(ProjectiveRadial(), np.array([1.0, 0, 0, 1.0, 0, 0, 0, 0, -0.3]), FRAME)

    np.testing.assert_allclose(warp(MOVING.centre[None])[0], MOVING.centre)


@each
def test_json_keeps_it_to_the_last_bit(warp, tmp_path):
    path = tmp_path / "transform.json"
    path.write_text(json.dumps({"warps": [json_files.record(warp)]}))

    read = files.read(path, Grid.of_shape((5, 5)))

    np.testing.assert_array_equal(read(AT), warp(AT))


def test_json_keeps_options_of_every_family(tmp_path):
    warp = Warp(BSpline(mesh=(3,)), 0.1 * np.arange(72.0), FRAME)
    path = tmp_path / "transform.json"
    path.write_text(json.dumps({"warps": [json_files.record(warp)]}))

    np.testing.assert_array_equal(files.read(path, FIXED)(AT), warp(AT))


@pytest.mark.parametrize(
    "text",
    ["", "{}", "[]", '{"warps": []}', '{"warps": [{"type": "rigd"}]}', '{"warps": [{"type": "rigid"}]}'],
)
def test_other_json_is_refused(text, tmp_path):
    path = tmp_path / "transform.json"
    path.write_text(text)

    with pytest.raises(GeometryError, match=r"transform\.json"):
        files.read(path, FIXED)


def test_json_of_other_dimensions_is_refused(tmp_path):
    volume = Grid.of_shape((5, 5, 5))
    warp = Warp(Rigid(), np.zeros(6), Frame.about_centre(volume))
    path = tmp_path / "transform.json"
    path.write_text(json.dumps({"warps": [json_files.record(warp)]}))

    with pytest.raises(GeometryError, match="number of axes"):
        files.read(path, FIXED)


@each
@pytest.mark.parametrize("suffix", [".tfm", ".h5"])
def test_itk_reads_it_as_a_displacement_field(warp, suffix, tmp_path):
    files.write(warp, tmp_path / f"warp{suffix}")

    theirs = sitk.ReadTransform(str(tmp_path / f"warp{suffix}"))

    assert theirs.GetName() == "DisplacementFieldTransform"
    found = np.array([theirs.TransformPoint(point.tolist()) for point in AT])
    assert np.abs(found - warp(AT)).max() < 0.02


def test_a_chain_with_a_homography_is_one_field(tmp_path):
    whole = WARPS[0] @ Warp(Rigid(), np.array([0.05, 2.0, 1.0]), FRAME)
    files.write(whole, tmp_path / "warp.tfm")

    theirs = sitk.ReadTransform(str(tmp_path / "warp.tfm"))

    found = np.array([theirs.TransformPoint(point.tolist()) for point in AT])
    assert np.abs(found - whole(AT)).max() < 0.02


def test_smoother_maps_need_fewer_nodes():
    steep, flat = (
        Warp(Projective(), np.array([1.0, 0, 0, 1.0, 0, 0, slant, 0.0]), FRAME) for slant in (0.3, 0.003)
    )

    assert displacement_field(steep)[0].size > 4 * displacement_field(flat)[0].size


def test_a_field_moves_points_without_an_image_far_away():
    grid, moved = displacement_field(Warp(Projective(), np.array([1.0, 0, 0, 1.0, 0, 0, 2.0, 0.0]), FRAME))

    assert np.isfinite(moved).all()
    assert np.abs(moved[grid.points(grid.all_indices())[:, 0] < 20]).min() > 1e5


def test_no_other_family_continues_a_homography():
    whole = Projective().as_homogeneous(WARPS[0].params, FRAME)

    with pytest.raises(GeometryError, match="cannot continue a homography"):
        Affine().from_homogeneous(whole, FRAME)


def test_lenses_continue_a_homography():
    whole = Projective().as_homogeneous(WARPS[0].params, FRAME)

    found = ProjectiveRadial().from_homogeneous(whole, FRAME)

    np.testing.assert_allclose(found, [*PLANE, 0.0], atol=1e-12)
