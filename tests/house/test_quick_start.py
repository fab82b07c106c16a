"""What starts quickly loads nothing heavy.

Times are three times what a quiet machine of two cores needs, and the best of three tries counts, since
tests run beside other work.
"""

import subprocess
import sys
from functools import cache

import pytest

HEAVY = {"matplotlib", "numba", "numpy", "pydantic", "scipy", "SimpleITK"}
HEAVY_FOR_HELP = HEAVY - {"numpy"}

STARTS = {
    "import regframe": "import regframe",
    "regframe --help": "from regframe.cli.main import main; sys.argv = ['regframe', '--help']; run(main)",
}

PROBE = """
import sys, time
def run(main):
    try:
        main()
    except SystemExit as end:
        assert not end.code
before, begin = set(sys.modules), time.process_time()
{code}
print(time.process_time() - begin, *sorted({{name.split(".")[0] for name in sys.modules.keys() - before}}))
"""


@cache
def start(name: str) -> tuple[float, set[str]]:
    """Processor seconds of the best of three tries, and the packages loaded."""
    seconds, loaded = [], set()
    for _ in range(3):
        code = PROBE.format(code=STARTS[name])
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        taken, *names = run.stdout.splitlines()[-1].split()
        seconds.append(float(taken))
        loaded = set(names)
    return min(seconds), loaded


@pytest.mark.parametrize(("name", "heavy"), [("import regframe", HEAVY), ("regframe --help", HEAVY_FOR_HELP)])
def test_loads_nothing_heavy(name, heavy):
    _, loaded = start(name)

    assert loaded & heavy == set()


@pytest.mark.parametrize(("name", "limit"), [("import regframe", 0.15), ("regframe --help", 0.4)])
def test_is_quick(name, limit):
    seconds, _ = start(name)

    assert seconds < 3 * limit
