"""Plugin files as users write them, right and wrong."""

GOOD = '''
from regframe import Metric

class LeastDistance(Metric):
    """Mean absolute difference (Brown, 1992); infinite without weight."""

    def value(self, pairs):
        mass = pairs.weight.sum()
        return float((pairs.weight * abs(pairs.fixed - pairs.moving)).sum() / mass) if mass else float("inf")
'''
REGISTERED = '''
from regframe import FILTERS, Filter

@FILTERS.register("chosen")
class Something(Filter):
    """Leaves everything as it is."""

    def __call__(self, image):
        return image
'''
TAKEN = (
    GOOD
    + '''

class Mattes(Metric):
    """Its name is taken (nobody, 1999)."""

    def value(self, pairs):
        return 0.0
'''
)
HALFWAY = REGISTERED + "\nraise RuntimeError('no gpu')\n"
