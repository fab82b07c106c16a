import numpy as np
import pytest

from regframe.io import read
from regframe.report import figures
from support.results import image, ramp, result

PLOTS = [figures.histograms, figures.joint_histogram, figures.convergence]


@pytest.mark.parametrize("plot", PLOTS)
def test_plots_become_pictures(plot, tmp_path):
    (tmp_path / "plot.png").write_bytes(figures.draw(plot(result())))

    picture = read(tmp_path / "plot.png").raw
    assert picture.shape[1] == 900
    assert np.ptp(picture) > 200


@pytest.mark.parametrize("plot", PLOTS)
def test_every_axis_says_what_it_shows(plot):
    axes = [one for one in plot(result()).axes if one.get_label() != "<colorbar>"]

    assert any(one.get_title(loc="left") for one in axes)
    assert any(one.get_xlabel() for one in axes)
    assert any(one.get_ylabel() for one in axes)


def test_plots_leave_no_figure_open():
    from matplotlib import pyplot

    figures.convergence(result())

    assert pyplot.get_fignums() == []


def test_histogram_titles_name_the_files_without_their_folders():
    made = result(fixed=image(ramp((12, 16)), "/far/away/visual.png"))

    assert figures.histograms(made).axes[0].get_title(loc="left") == "fixed: visual.png"


def test_every_second_level_is_shaded():
    upper, lower = figures.convergence(result()).axes

    assert len(upper.patches) == len(lower.patches) == 1


def test_sizes_over_several_decades_get_a_logarithmic_axis():
    made = result()
    for step, size in zip(made.trace, np.geomspace(10, 1e-3, len(made.trace)), strict=True):
        object.__setattr__(step, "size", float(size))

    assert figures.convergence(made).axes[1].get_yscale() == "log"


def test_volumes_have_plots_too():
    one = image(ramp((6, 8, 10), np.float32), "volume.nii.gz")
    made = result(one, one, shift=(0, 0, 0))

    assert all(figures.draw(plot(made)) for plot in PLOTS)
