from regframe.testing import conformance
from regframe_destripe import Destripe

test_conformance = conformance(Destripe(), Destripe(direction="both", sigma=2.0))
