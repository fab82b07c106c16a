"""Same preset, seed and images: the same bits, whatever the number of threads."""

import hashlib

import pytest

from regframe.engine.native import Native
from regframe.preset import parse
from support import sitk as peer

OPTIMIZERS = ["one-plus-one", "regular-step-gradient-descent"]


def digest(optimizer: str, metric: str, sampling: dict) -> str:
    fixed, moving = peer.pair((90, 110))
    stage = {
        "transform": "affine",
        "interpolator": {"type": "bspline", "order": 3},
        "metric": metric,
        "optimizer": optimizer,
        "levels": [{"shrink": 2, "smooth": 1.0, "iterations": 12}, {"iterations": 12, **sampling}],
    }
    steps = Native().iterate(parse({"name": "test", "stages": [stage]}), fixed, moving)
    text = hashlib.sha256()
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            return text.hexdigest() + end.value.warp.params.tobytes().hex()
        text.update(progress.params.tobytes())


@pytest.mark.parametrize("optimizer", OPTIMIZERS)
@pytest.mark.parametrize("metric", ["mattes", "mean-squares", "correlation"])
@pytest.mark.parametrize("sampling", [{}, {"sampling": "random", "fraction": 0.5}], ids=["all", "random"])
def test_bits_do_not_depend_on_threads(optimizer, metric, sampling, monkeypatch):
    found = set()

    for threads in ("1", "2", "4"):
        monkeypatch.setenv("REGFRAME_THREADS", threads)
        found.add(digest(optimizer, metric, sampling))

    assert len(found) == 1
