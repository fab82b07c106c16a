from regframe.testing import conformance
from regframe_correlation_ratio import CorrelationRatio

test_conformance = conformance(CorrelationRatio())
