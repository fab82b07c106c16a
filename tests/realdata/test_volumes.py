"""Whole heads in 3-D: a template's T1 against warps of itself that are known, and against CT."""

import numpy as np
import pytest
import SimpleITK as sitk

import regframe
from regframe.io import read

FOLDER = "multimodal_3d"
T1 = "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz"
CT = "ct_template_2mm.nii"

pytestmark = pytest.mark.slow


def rigid(centre):
    """Turns of 4, -3 and 5 degrees, and a shift of 10 mm."""
    return sitk.Euler3DTransform(centre, *np.deg2rad([4.0, -3.0, 5.0]), (6.0, -5.0, 7.0))


def affine(centre):
    """Scales and shears of up to 5 %, turns of about 3 degrees, and a shift of 9 mm."""
    turned = np.array(sitk.Euler3DTransform((0.0, 0.0, 0.0), 0.05, -0.04, 0.06).GetMatrix()).reshape(3, 3)
    stretched = np.array([[1.05, 0.04, 0.0], [0.0, 0.96, 0.05], [0.03, 0.0, 1.03]])
    known = sitk.AffineTransform(3)
    known.SetCenter(centre)
    known.SetMatrix((turned @ stretched).ravel())
    known.SetTranslation((5.0, -6.0, 4.0))
    return known


def brain_points(image, every: int = 5000):
    """Centres of some voxels of the brain, mm; outside it the template is 0."""
    return image.grid.points(np.argwhere(image.values > 0)[::every].astype(np.float64))


@pytest.mark.parametrize(
    ("preset", "kind"), [("brain-rigid", rigid), ("brain-affine", affine)], ids=["rigid", "affine"]
)
def test_known_warp_is_found(data, preset, kind):
    path = data / FOLDER / T1
    still = sitk.ReadImage(str(path), sitk.sitkFloat32)
    known = kind(still.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in still.GetSize()]))
    moved = sitk.Resample(still, still, known.GetInverse(), sitk.sitkBSpline3, 0.0)
    points = brain_points(read(path))
    true = np.array([known.TransformPoint(point) for point in points.tolist()])

    result = regframe.register(preset, still, moved)

    assert np.linalg.norm(true - points, axis=1).mean() > 9.0
    assert np.linalg.norm(result.warp(points) - true, axis=1).mean() < 0.1


def test_t1_and_ct_templates_stay_together(data):
    points = brain_points(read(data / FOLDER / T1))

    result = regframe.register("brain-rigid", data / FOLDER / T1, data / FOLDER / CT)

    # The two are templates of different people, aligned to about 2 mm.
    assert np.linalg.norm(result.warp(points) - points, axis=1).mean() < 3.0


@pytest.mark.parametrize(
    ("kind", "begun", "bound"), [(None, 0.0, 3.0), (rigid, 10.0, 5.0)], ids=["as is", "turned"]
)
def test_the_preset_for_ct_and_mr(data, kind, begun, bound):
    """Two people's templates at best; its hundredth of the points then leaves it some mm from there.

    Measured: 2.3 mm, and 4.2 mm from a start that is 12 mm off.
    """
    still = sitk.ReadImage(str(data / FOLDER / T1), sitk.sitkFloat32)
    points = brain_points(read(data / FOLDER / T1))
    true = points
    if kind is not None:
        known = kind(still.TransformContinuousIndexToPhysicalPoint([(n - 1) / 2 for n in still.GetSize()]))
        still = sitk.Resample(still, still, known.GetInverse(), sitk.sitkBSpline3, 0.0)
        true = np.array([known.TransformPoint(point) for point in points.tolist()])

    result = regframe.register("brain-ct-mr", data / FOLDER / CT, still)

    assert np.linalg.norm(true - points, axis=1).mean() >= begun
    assert np.linalg.norm(result.warp(points) - true, axis=1).mean() < bound
