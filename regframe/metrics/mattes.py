"""Mattes mutual information."""

from typing import ClassVar, Literal, final

import numpy as np
from pydantic import Field

from regframe.kernels import cross_information, parzen
from regframe.metrics.base import Metric, Pairs, Translations
from regframe.metrics.parzen_histogram import Axes, axes, counts, joint_of, slopes_of
from regframe.types import Values


@final
class Mattes(Metric):
    """Negative mutual information of a Parzen-windowed joint histogram, in nats.

    After Mattes, Haynor, Vesselle, Lewellen and Eubank, "PET-CT image registration in the chest using
    free-form deformations", IEEE Transactions on Medical Imaging 22(1), 2003: windows of order 0 on the
    fixed and order 3 on the moving intensities. As in ITK, a moving value outside the range of the
    moving image's pixels (a spline's overshoot) does not count. Departures from ITK: its derivative is
    minus ours, and without any sample the value is infinite instead of an error.
    """

    bins: int = Field(50, ge=5, le=1024, description="Bins an axis; the outer two at each end stay free.")

    range_of: ClassVar[Literal["image", "samples"]] = "samples"
    suits: ClassVar[tuple[str, ...]] = ("mono", "inverted", "multimodal")
    unrelated: ClassVar[float | None] = 0.0
    invariant_to: ClassVar[tuple[str, ...]] = ("shift", "scale", "inversion")

    def prepare(self, pairs: Pairs) -> Axes:
        """Fixed bins of all samples and the moving axis."""
        return axes(pairs, self.bins)

    def value(self, pairs: Pairs) -> float:
        """Negative mutual information.

        With P(k, l) the share of all windows that falls into fixed bin k and moving bin l, and pf and pm
        its sums by row and column:
        value = - sum P(k, l) ln( P(k, l) / (pf(k) pm(l)) ).
        """
        return -parzen.information(joint_of(pairs, self.bins)[0])

    def derivative(self, pairs: Pairs) -> Values:
        """Slope of the value by each moving intensity."""
        return self.value_and_derivative(pairs)[1]

    def value_and_derivative(self, pairs: Pairs) -> tuple[float, Values]:
        """The value, and its slope by each moving intensity, from one histogram.

        The marginals' terms cancel, so only the window's own slope remains (Thevenaz and Unser,
        "Optimization of mutual information for multiresolution image registration", IEEE Transactions on
        Image Processing 9(12), 2000): d value / d P(k, l) = - ln( P(k, l) / pm(l) ).
        """
        joint, mass = joint_of(pairs, self.bins)
        log = np.log(np.divide(joint, joint.sum(axis=0), out=np.ones_like(joint), where=counts(joint)))
        return -parzen.information(joint), slopes_of(pairs, self.bins, -log, mass)

    def translations(self, pairs: Pairs, lattice: tuple[int, ...]) -> Translations:
        """Mutual information of a few classes of intensity at all translations, by FFT."""
        shape = pairs.shape or pairs.weight.shape
        return cross_information.scorer(pairs.fixed.reshape(shape), pairs.weight.reshape(shape), lattice)
