from regframe.testing import conformance
from regframe_lanczos import Lanczos

test_conformance = conformance(Lanczos(), Lanczos(radius=2))
