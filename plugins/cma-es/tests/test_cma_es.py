from regframe.testing import conformance
from regframe_cma_es import CmaEs

test_conformance = conformance(CmaEs(), CmaEs(reach=20.0, population=20))
