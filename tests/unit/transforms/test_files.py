from typing import final

import numpy as np
import pytest
import SimpleITK as sitk

from regframe.errors import GeometryError, OutputError
from regframe.geometry import AffineMap, Frame, Grid
from regframe.transforms import files
from regframe.transforms.affine import Affine
from regframe.transforms.base import Transform
from regframe.transforms.rigid import Rigid
from regframe.transforms.similarity import Similarity
from regframe.transforms.translation import Translation
from regframe.transforms.warp import Chain, Warp

PLANE = Grid((48, 64), (0.5, 0.75), (-3.0, 7.0), ((0.8, -0.6), (0.6, 0.8)))
VOLUME = Grid(
    (5, 6, 7), (1.0, 2.0, 3.0), (1.0, 2.0, 3.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
)
# Thirds and a tiny number: digits that a short decimal does not hold.
WARPS = {
    "translation": Warp(Translation(), np.array([1 / 3, -1e-17]), Frame.about_centre(PLANE)),
    "rigid": Warp(Rigid(), np.array([0.1, 12345.678901234567, 2 / 3]), Frame.about_centre(PLANE)),
    "similarity": Warp(
        Similarity(), np.array([1 / 0.41, -0.02, 16.1, 125.7]), Frame(PLANE, np.array([1 / 7, 3.3]))
    ),
    "affine": Warp(Affine(), np.array([1.1, 0.01, -1 / 30, 0.9, 5.0, 1 / 3]), Frame.about_centre(PLANE)),
    "affine in 3-D": Warp(Affine(), np.linspace(0.1, 2, 12), Frame(VOLUME, np.array([1 / 3, 2.0, 3.0]))),
    "translation in 3-D": Warp(Translation(), np.array([1.0, 2.0, 1 / 3]), Frame.about_centre(VOLUME)),
}
SUFFIXES = [".tfm", ".txt", ".h5", ".hdf5"]


@final
class Bent(Transform):
    """A transform of nobody's, not affine."""

    def identity(self, frame):
        return np.zeros(1)

    def map(self, params, points, frame):
        return points + params[0] * points**2


@final
class Stretch(Transform):
    """A transform of nobody's, affine."""

    def identity(self, frame):
        return np.ones(1)

    def map(self, params, points, frame):
        return points * params[0]

    def as_affine(self, params, frame):
        return AffineMap(np.eye(frame.dim) * params[0], np.zeros(frame.dim))


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("name", WARPS)
def test_a_warp_comes_back_to_the_last_bit(tmp_path, name, suffix):
    warp = WARPS[name]

    files.write(warp, tmp_path / f"warp{suffix}")
    back = files.read(tmp_path / f"warp{suffix}", warp.frame.grid)

    assert isinstance(back, Warp)
    assert type(back.transform) is type(warp.transform)
    assert back.frame.grid == warp.frame.grid
    np.testing.assert_array_equal(back.params, warp.params)
    np.testing.assert_array_equal(back.frame.centre, warp.frame.centre)


@pytest.mark.parametrize("suffix", [".tfm", ".h5"])
@pytest.mark.parametrize("name", WARPS)
def test_simpleitk_maps_points_as_we_do(tmp_path, name, suffix):
    warp = WARPS[name]
    points = np.random.default_rng(0).normal(0, 100, (50, warp.frame.dim))

    files.write(warp, tmp_path / f"warp{suffix}")

    theirs = sitk.ReadTransform(str(tmp_path / f"warp{suffix}"))
    mapped = [theirs.TransformPoint(point) for point in points.tolist()]
    np.testing.assert_allclose(warp(points), mapped, rtol=1e-14, atol=1e-12)


@pytest.mark.parametrize("suffix", [".tfm", ".h5"])
def test_a_chain_keeps_its_order(tmp_path, suffix):
    chain = WARPS["similarity"] @ WARPS["affine"] @ WARPS["translation"]
    points = np.random.default_rng(0).normal(0, 100, (20, 2))

    files.write(chain, tmp_path / f"chain{suffix}")
    back = files.read(tmp_path / f"chain{suffix}", PLANE)

    theirs = sitk.ReadTransform(str(tmp_path / f"chain{suffix}"))
    mapped = [theirs.TransformPoint(point) for point in points.tolist()]
    assert isinstance(back, Chain)
    assert [type(warp.transform) for warp in back.warps] == [Similarity, Affine, Translation]
    np.testing.assert_array_equal(back(points), chain(points))
    np.testing.assert_allclose(chain(points), mapped, rtol=1e-14, atol=1e-12)


def test_an_affine_warp_of_another_family_becomes_an_affine_transform(tmp_path):
    warp = Warp(Stretch(), np.array([2.5]), Frame.about_centre(PLANE))

    files.write(warp, tmp_path / "warp.tfm")
    back = files.read(tmp_path / "warp.tfm", PLANE)

    points = PLANE.corners()
    assert isinstance(back.transform, Affine)
    np.testing.assert_allclose(back(points), warp(points), rtol=1e-13)


def test_a_warp_that_itk_lacks_is_written_as_a_field(tmp_path):
    warp = Warp(Bent(), np.array([1e-3]), Frame.about_centre(PLANE))

    files.write(warp, tmp_path / "warp.tfm")
    theirs = sitk.ReadTransform(str(tmp_path / "warp.tfm"))

    for point in PLANE.corners():
        np.testing.assert_allclose(theirs.TransformPoint(point.tolist()), warp(point[None])[0], atol=0.01)


def euler():
    return sitk.Euler3DTransform((1.0, 2.0, 3.0), 0.1, 0.2, -0.3, (4.0, 5.0, 6.0))


def similarity():
    return sitk.Similarity3DTransform(1.7, (0.0, 0.6, 0.8), 0.4, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))


def versor_rigid():
    return sitk.VersorRigid3DTransform((0.6, 0.0, 0.8), 0.4, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))


def versor():
    made = sitk.VersorTransform((0.6, 0.0, 0.8), 0.4)
    made.SetCenter((4.0, 5.0, 6.0))
    return made


def scale():
    made = sitk.ScaleTransform(3, (1.5, 2.0, 0.5))
    made.SetCenter((4.0, 5.0, 6.0))
    return made


def scale_versor():
    return sitk.ScaleVersor3DTransform(
        (1.1, 1.2, 0.9), (0.6, 0.0, 0.8), 0.4, (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)
    )


def scale_skew_versor():
    made = sitk.ScaleSkewVersor3DTransform()
    made.SetParameters([0.1, 0.2, 0.1, 1.0, 2.0, 3.0, 1.1, 1.2, 0.9, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06])
    made.SetCenter((4.0, 5.0, 6.0))
    return made


@pytest.mark.parametrize("suffix", [".tfm", ".h5", ".mat"])
@pytest.mark.parametrize(
    "make",
    [euler, similarity, versor_rigid, versor, scale, scale_versor, scale_skew_versor],
    ids=lambda f: f.__name__,
)
def test_families_that_we_lack_come_as_affine(tmp_path, make, suffix):
    theirs = make()
    sitk.WriteTransform(theirs, str(tmp_path / f"theirs{suffix}"))
    points = np.random.default_rng(0).normal(0, 100, (20, 3))

    warp = files.read(tmp_path / f"theirs{suffix}", VOLUME)

    mapped = [theirs.TransformPoint(point) for point in points.tolist()]
    assert isinstance(warp.transform, Affine)
    np.testing.assert_array_equal(warp.frame.centre, theirs.GetCenter())
    np.testing.assert_allclose(warp(points), mapped, rtol=1e-13, atol=1e-12)


def test_a_plain_matrix_and_offset_comes_as_affine(tmp_path):
    (tmp_path / "ants.tfm").write_text(
        "#Insight Transform File V1.0\n#Transform 0\nTransform: MatrixOffsetTransformBase_double_2_2\n"
        "Parameters: 1.1 0.2 0.3 0.9 5 6\nFixedParameters: 7 8\n"
    )

    warp = files.read(tmp_path / "ants.tfm", PLANE)

    assert isinstance(warp.transform, Affine)
    np.testing.assert_array_equal(warp.params, [1.1, 0.2, 0.3, 0.9, 5, 6])
    np.testing.assert_array_equal(warp.frame.centre, [7, 8])


@pytest.mark.parametrize("theirs", [sitk.Transform(2, sitk.sitkIdentity), sitk.CompositeTransform(2)])
def test_the_identity_comes_as_a_translation(tmp_path, theirs):
    sitk.WriteTransform(theirs, str(tmp_path / "identity.tfm"))

    warp = files.read(tmp_path / "identity.tfm", PLANE)

    assert isinstance(warp.transform, Translation)
    np.testing.assert_array_equal(warp.params, [0, 0])
    np.testing.assert_array_equal(warp.frame.centre, PLANE.centre)


def test_names_both_dimensions_where_they_differ(tmp_path):
    files.write(WARPS["affine in 3-D"], tmp_path / "warp.tfm")

    with pytest.raises(GeometryError, match="the transform is 3-D and the image 2-D"):
        files.read(tmp_path / "warp.tfm", PLANE)


def test_tells_a_missing_file(tmp_path):
    with pytest.raises(GeometryError, match="there is no such transform file"):
        files.read(tmp_path / "none.tfm", PLANE)


def test_lists_known_suffixes(tmp_path):
    (tmp_path / "warp.xyz").touch()

    with pytest.raises(GeometryError, match=r"suffix '\.xyz'\. Known: \.tfm"):
        files.read(tmp_path / "warp.xyz", PLANE)
    with pytest.raises(OutputError, match=r"not written as '\.xyz'\. Use \.tfm"):
        files.write(WARPS["rigid"], tmp_path / "other.xyz")


@pytest.mark.parametrize("suffix", [".tfm", ".txt", ".h5", ".mat"])
@pytest.mark.parametrize("content", ["", "hello\n", "hello: there\n" * 50])
def test_tells_what_is_no_transform_in_one_line(tmp_path, suffix, content, capfd):
    (tmp_path / f"warp{suffix}").write_text(content)

    with pytest.raises(GeometryError, match=r"damaged|holds no transform") as fault:
        files.read(tmp_path / f"warp{suffix}", PLANE)

    assert "\n" not in str(fault.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("share", [0.4, 0.6, 0.8])
@pytest.mark.parametrize("suffix", [".tfm", ".h5"])
def test_tells_a_truncated_file(tmp_path, suffix, share):
    path = tmp_path / f"chain{suffix}"
    files.write(WARPS["similarity"] @ WARPS["affine"], path)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])

    with pytest.raises(GeometryError, match="damaged"):
        files.read(path, PLANE)


def test_never_overwrites_without_force(tmp_path):
    path = tmp_path / "warp.tfm"
    files.write(WARPS["rigid"], path)

    with pytest.raises(OutputError, match="--force"):
        files.write(WARPS["affine"], path)
    files.write(WARPS["affine"], path, force=True)

    assert isinstance(files.read(path, PLANE).transform, Affine)
    assert [one.name for one in tmp_path.iterdir()] == ["warp.tfm"]


def test_tells_what_simpleitk_cannot_write_in_one_line(tmp_path, monkeypatch):
    def fail(*_):
        message = "Exception thrown in SimpleITK:\nITK ERROR: TxtTransformIO(0x55d5): The disk is full.\n"
        raise RuntimeError(message)

    monkeypatch.setattr("SimpleITK.WriteTransform", fail)

    with pytest.raises(OutputError, match=r"warp\.tfm': The disk is full\. Name another place\.$"):
        files.write(WARPS["rigid"], tmp_path / "warp.tfm")

    assert list(tmp_path.iterdir()) == []
