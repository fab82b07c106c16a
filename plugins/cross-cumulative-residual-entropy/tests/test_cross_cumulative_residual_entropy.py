from regframe.testing import conformance
from regframe_cross_cumulative_residual_entropy import CrossCumulativeResidualEntropy

test_conformance = conformance(
    CrossCumulativeResidualEntropy(), CrossCumulativeResidualEntropy(normalized=False)
)
