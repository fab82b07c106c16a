"""Sums over all translations, against sums taken one by one."""

import numpy as np
import pytest

from regframe.kernels import cross_information, fourier


def planes(seed, shape):
    return np.random.default_rng(seed).random(shape)


def shifted(moving, offset, shape):
    """What fixed points of a grid meet, zeros beyond the moving image."""
    out = np.zeros(shape)
    for y, x in np.ndindex(*shape):
        at = y + offset[0], x + offset[1]
        if 0 <= at[0] < moving.shape[0] and 0 <= at[1] < moving.shape[1]:
            out[y, x] = moving[at]
    return out


@pytest.mark.parametrize("offset", [(0, 0), (3, -2), (-4, 1)])
def test_correlation_equals_the_sum_at_a_translation(offset):
    fixed, moving, lattice = planes(1, (2, 7, 9)), planes(2, (2, 6, 8)), (16, 18)

    found = fourier.correlate(fourier.spectra(fixed, lattice), fourier.spectra(moving, lattice), lattice)

    wanted = sum(float((a * shifted(b, offset, (7, 9))).sum()) for a, b in zip(fixed, moving, strict=True))
    # Single precision: 1e-7 of sums of some tens.
    assert found[offset] == pytest.approx(wanted, abs=1e-4)


@pytest.mark.parametrize("offset", [(0, 0), (2, -3)])
def test_information_equals_that_of_the_joint_histogram(offset):
    fixed, moving, lattice = planes(3, (20, 24)), planes(4, (20, 24)), (48, 54)
    moving = moving + 0.5 * shifted(fixed, (-2, 3), moving.shape)
    there = np.ones(fixed.shape)
    cuts = [cross_information.edges(one, there, 4) for one in (fixed, moving)]
    below, above = (
        cross_information.classes(one, there, cut) for one, cut in zip((fixed, moving), cuts, strict=True)
    )

    found, shared = cross_information.information(fourier.spectra(below, lattice), above, lattice)

    joint = np.array([[(a * shifted(b, offset, fixed.shape)).sum() for b in above] for a in below])
    share = joint / joint.sum()
    outer = np.outer(share.sum(axis=1), share.sum(axis=0))
    wanted = float((share[joint > 0] * np.log(share[joint > 0] / outer[joint > 0])).sum())
    assert shared[offset] == pytest.approx(joint.sum(), abs=1e-2)
    assert found[offset] == pytest.approx(wanted, abs=1e-4)


def test_repeated_intensities_leave_fewer_classes():
    values = np.repeat([0.0, 1.0], [90, 10])

    cuts = cross_information.edges(values, np.ones(100), 8)

    assert len(cross_information.classes(values, np.ones(100), cuts)) == 2
