"""The table of lines is right where it speaks of our own code, and a user's metric stays short."""

from importlib.util import module_from_spec, spec_from_file_location

import pytest

from house.source import REPOSITORY

PAGE = REPOSITORY / "docs" / "explanation" / "lines-of-a-metric.md"
PLUGIN = REPOSITORY / "plugins" / "correlation-ratio" / "regframe_correlation_ratio" / "__init__.py"
OURS = {
    "mean squares": ("regframe/metrics/mean_squares.py",),
    "mutual information": (
        "regframe/metrics/mattes.py",
        "regframe/metrics/parzen_histogram.py",
        "regframe/kernels/parzen.py",
    ),
}
MOST = 15


@pytest.fixture(scope="module")
def count():
    spec = spec_from_file_location("count_lines", REPOSITORY / "docs" / "count_lines.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.count


def test_a_users_correlation_ratio_is_short(count):
    lines = count(str(PLUGIN))

    assert lines <= MOST
    assert f"has {lines} lines" in PAGE.read_text(encoding="utf-8")


def test_our_row_is_counted_anew(count):
    counted = [sum(count(str(REPOSITORY / file)) for file in files) for files in OURS.values()]

    row = next(
        line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| regframe")
    )
    assert [int(cell) for cell in row.split("|")[3:5]] == counted


@pytest.mark.parametrize(
    ("name", "text", "lines"),
    [
        ("a.py", '"""Doc."""\n\n# why\nx = 1  # what\ny = """a\nb"""\n', 3),
        (
            "a.py",
            'class A:\n    """Doc.\n\n    More."""\n\n    def f(self):\n        return [\n            1]\n',
            4,
        ),
        ("a.h", '/* licence\n * more */\n#include "a//b.h"\n\nint a; // what\n/** doc */ int b;\n', 3),
        ("a.pyx", '"""Doc."""\ncdef int a  # what\n\n# why\n', 1),
        ("a.pyx", 'def f():\n    r"""Doc.\n\n    More."""\n    return 1\n', 2),
    ],
)
def test_counts_code_alone(name, text, lines, count, tmp_path):
    (tmp_path / name).write_text(text)

    assert count(str(tmp_path / name)) == lines


def test_counts_one_class(count, tmp_path):
    (tmp_path / "a.py").write_text("x = 1\n\n\nclass A:\n    y = 2\n\n\nclass B:\n    z = 3\n    w = 4\n")

    assert count(f"{tmp_path / 'a.py'}:B") == 3
