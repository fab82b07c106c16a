"""ITK's brain slices: known shift and rotation, by Mattes mutual information and either optimizer."""

import json

import numpy as np
import pytest

import regframe

FOLDER = "multimodal_2d/itk_brain"
EVOLUTION = {"type": "one-plus-one", "radius": 2.0}
DESCENT = {"type": "regular-step-gradient-descent", "learning_rate": 2.0, "gradient_tolerance": 0.0}
LEVELS = [
    {"shrink": 4, "smooth": 2.0, "iterations": 200},
    {"shrink": 2, "smooth": 1.0, "iterations": 200},
    {"shrink": 1, "smooth": 0.0, "iterations": 200},
]


def preset(transform, optimizer):
    return {
        "name": "brain",
        "stages": [
            {
                "start": "centres",
                "transform": transform,
                # Linear interpolation blurs between pixels, which pulls the optimum off whole shifts.
                "interpolator": "bspline",
                "metric": {"type": "mattes", "bins": 32},
                "optimizer": optimizer,
                "levels": LEVELS,
            }
        ],
    }


def error_px(result, truth) -> float:
    """Mean distance over the brain between the found and the true place of a pixel."""
    y, x = np.mgrid[40:217:20, 40:181:20].reshape(2, -1)
    at = np.column_stack([x, y, np.ones(x.size)])
    return float(np.linalg.norm((at @ result.pixel_matrix.T - at @ truth.T)[:, :2], axis=1).mean())


def truth_of(folder, name):
    known = json.loads((folder / "ground_truth" / name).read_text())
    return np.vstack([np.array(known["matrix"])[:2], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("optimizer", [EVOLUTION, DESCENT], ids=["evolution", "descent"])
@pytest.mark.parametrize("fixed", ["BrainT1SliceBorder20.png", "BrainProtonDensitySliceBorder20.png"])
def test_shift_is_found(data, optimizer, fixed):
    folder = data / FOLDER

    result = regframe.register(
        preset("translation", optimizer), folder / fixed, folder / "BrainProtonDensitySliceShifted13x17y.png"
    )

    assert error_px(result, truth_of(folder, "shift_13_17.json")) < 0.3


@pytest.mark.parametrize("optimizer", [EVOLUTION, DESCENT], ids=["evolution", "descent"])
@pytest.mark.parametrize("fixed", ["BrainT1SliceBorder20.png", "BrainProtonDensitySliceBorder20.png"])
def test_rotation_is_found(data, optimizer, fixed):
    folder = data / FOLDER

    result = regframe.register(
        preset("rigid", optimizer), folder / fixed, folder / "BrainProtonDensitySliceR10X13Y17.png"
    )

    assert error_px(result, truth_of(folder, "rigid_10deg_13_16.json")) < 0.5


def test_shift_is_found_on_oblique_grids(data):
    folder = data / FOLDER

    result = regframe.register(
        preset("translation", EVOLUTION),
        folder / "BrainT1SliceBorder20DirectionPlus30.mhd",
        folder / "BrainProtonDensitySliceShifted13x17yDirectionPlus30.mhd",
    )

    assert error_px(result, truth_of(folder, "shift_13_17.json")) < 0.3
