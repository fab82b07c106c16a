import pytest

from regframe.catalog import KINDS, METRICS
from regframe.cli.listing import PLURALS, first_sentence
from regframe.metrics.mean_squares import MeanSquares
from regframe.preset import names


@pytest.mark.parametrize("kind", PLURALS[:-1])
def test_every_name_of_a_kind_is_listed_with_its_summary(kind, regframe):
    outcome = regframe("list", kind)

    lines = {line.split()[0]: line.split() for line in outcome.out.splitlines()[1:]}
    assert sorted(lines) == KINDS[kind].names()
    assert all(len(words) > 3 and words[-1] == "regframe" for words in lines.values())
    assert "unusable" not in outcome.out


def test_presets_are_listed(regframe):
    lines = regframe("list", "presets").out.splitlines()[1:]

    assert [line.split()[0] for line in lines] == names()


def test_all_kinds_are_listed_when_none_is_named(regframe):
    outcome = regframe("list")

    assert [line for line in outcome.out.splitlines() if line in PLURALS] == list(PLURALS)


def test_components_of_this_session_are_listed(regframe):
    class Own(MeanSquares.__base__):
        """A metric of one's own."""

        def value(self, pairs):
            return 0.0

    METRICS.register("own")(Own)
    try:
        outcome = regframe("list", "metrics")
    finally:
        METRICS.forget("own")

    assert "A metric of one's own." in outcome.out
    assert "this session" in outcome.out


def test_a_misspelt_kind_is_told(regframe):
    outcome = regframe("list", "metric")

    assert outcome.code == 2
    assert "Did you mean 'metrics'?" in outcome.err


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("One. Two.", "One."),
        ("One\nline. Two.", "One line."),
        ("By J. Doe, 1.5 times. Two.", "By J. Doe, 1.5 times."),
        ("No end", "No end"),
        ("", ""),
    ],
)
def test_the_first_sentence_stands_for_the_whole(text, sentence):
    assert first_sentence(text) == sentence
