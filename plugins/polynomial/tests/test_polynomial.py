from regframe.testing import conformance
from regframe_polynomial import Polynomial

test_conformance = conformance(Polynomial(), Polynomial(degree=2), Polynomial(degree=5))
