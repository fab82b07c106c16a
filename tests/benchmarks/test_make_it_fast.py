"""The figures of docs/how-to/make-it-fast.md: its four files timed in one run.

``pytest -m slow tests/benchmarks/test_make_it_fast.py -s`` prints the page's table: the best of many calls at
640 x 512, all pixels, cubic B-spline, a similarity, two threads. The test asserts a fraction of what a quiet
machine shows, so that a busy one does not fail it.
"""

from time import perf_counter

import numpy as np
import pytest

from house.pages import blocks
from house.source import REPOSITORY
from regframe import plugins
from regframe.catalog import METRICS, TRANSFORMS
from regframe.metrics.base import Pairs
from regframe.transforms.warp import Warp
from support import sitk as peer
from support.objectives import objective

pytestmark = pytest.mark.slow

PAGE = REPOSITORY / "docs" / "how-to" / "make-it-fast.md"
STEPS = ("a loop", "whole arrays", "a kernel", "a kernel and its slope")
SHAPE, ROUNDS = (512, 640), 12
REPEATS = {"a loop": 1}


@pytest.fixture
def metrics(tmp_path):
    """The page's metrics, one a step, each from a file of its own."""
    codes = [block.code for block in blocks(PAGE) if block.file == "robust.py"]
    made = {}
    for number, (step, code) in enumerate(zip(STEPS, codes, strict=True)):
        file = tmp_path / f"step_{number}.py"
        file.write_text(code)
        assert plugins.load(file).faults == ()
        made[step] = METRICS.build("robust")
        METRICS.forget("robust")
    return made


def seconds(call, repeats):
    spans = []
    for _ in range(repeats):
        began = perf_counter()
        call()
        spans.append(perf_counter() - began)
    return min(spans)


def table(head, rows):
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ["---", *["---:"] * (len(head) - 1)], *rows))


def test_each_step_pays(metrics, monkeypatch, capsys):
    monkeypatch.setenv("REGFRAME_THREADS", "2")
    fixed, moving = peer.pair(SHAPE)
    still, other = (np.asarray(image.values, np.float64).ravel() for image in (fixed, moving))
    pairs = Pairs(still, other, np.ones_like(still), fixed.range(), moving.range())
    warp = Warp(TRANSFORMS.build("similarity"), np.array([1.02, 0.03, 3.3, -2.2]), peer.frame(fixed))
    ready = {
        step: objective(fixed, moving, warp, "bspline3", metric=metric) for step, metric in metrics.items()
    }
    calls = {
        "value, ms": {step: lambda m=metric: m.value(pairs) for step, metric in metrics.items()},
        "evaluation, ms": {step: lambda o=one: o.values(warp.params[None]) for step, one in ready.items()},
        "gradient, ms": {
            step: lambda o=one: o.value_and_gradient(warp.params) for step, one in ready.items()
        },
    }
    for column in calls.values():
        for call in column.values():
            call()

    found: dict[tuple[str, str], float] = {}
    for number in range(ROUNDS):
        for name, column in calls.items():
            for step, call in column.items():
                if step != "a loop" or number == 0:
                    took = seconds(call, REPEATS.get(step, 3))
                    found[step, name] = min(took, found.get((step, name), took))

    cells = {key: 1e3 * took for key, took in found.items()}
    rows = [[step, *(f"{cells[step, name]:.3g}" for name in calls)] for step in STEPS]
    values = [metric.value(pairs) for metric in metrics.values()]
    with capsys.disabled():
        print(f"\n{table(['step', *calls], rows)}")
    assert values == pytest.approx([values[0]] * 4, rel=1e-12)  # the same sums in other orders
    assert cells["a loop", "value, ms"] > 20 * cells["whole arrays", "value, ms"]
    assert cells["whole arrays", "value, ms"] > cells["a kernel", "value, ms"]
    assert cells["a kernel", "gradient, ms"] > 1.5 * cells["a kernel and its slope", "gradient, ms"]
