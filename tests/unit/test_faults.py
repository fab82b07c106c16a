from typing import Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from regframe.faults import LONGEST, fault, lines, nearest, raised, shown, told


class Inner(BaseModel):
    model_config = ConfigDict(extra="forbid")
    size: int = Field(1, ge=1, le=9, strict=True)
    share: float = Field(0.5, gt=0, lt=1, strict=True, allow_inf_nan=False)
    word: Literal["left", "right"] = "left"
    on: bool = Field(True, strict=True)
    text: str = Field("x", min_length=1)
    even: int = 2

    @field_validator("even")
    @classmethod
    def _even(cls, even: int) -> int:
        if even % 2:
            message = "must be even"
            raise ValueError(message)
        return even


class Outer(BaseModel):
    model_config = ConfigDict(extra="forbid")
    inner: Inner = Inner()
    many: tuple[Inner, ...] = Field((Inner(),), min_length=1, max_length=2)
    wanted: str = Field("", examples=["this"])


class Needy(BaseModel):
    wanted: str = Field(examples=["this"])
    plain: str


def told_lines(tree: object, model: type[BaseModel] = Outer) -> list[str]:
    with pytest.raises(ValidationError) as caught:
        model.model_validate(tree)
    return lines(caught.value, model)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"size": 0}, "size: must be at least 1. Got 0."),
        ({"size": 10}, "size: must be at most 9. Got 10."),
        ({"size": 1.5}, "size: must be a whole number. Got 1.5."),
        ({"size": "3"}, "size: must be a whole number. Got '3'."),
        ({"share": 0.0}, "share: must be greater than 0. Got 0.0."),
        ({"share": 1.0}, "share: must be less than 1. Got 1.0."),
        ({"share": "half"}, "share: must be a number. Got 'half'."),
        ({"share": float("inf")}, "share: must be a finite number. Got inf."),
        ({"word": "lft"}, "word: must be 'left' or 'right'. Got 'lft'. Did you mean 'left'?"),
        ({"word": 3}, "word: must be 'left' or 'right'. Got 3."),
        ({"on": "yes"}, "on: must be true or false. Got 'yes'."),
        ({"text": 3}, "text: must be text in quotes. Got 3."),
        ({"text": ""}, "text: has too few characters: at least 1. Got ''."),
        ({"even": 3}, "even: must be even. Got 3."),
        ({"sise": 3}, "sise: unknown option. Did you mean 'size'? Known: size, share, word, on, text, even."),
    ],
)
def test_a_fault_is_one_line_with_its_path(options, line):
    assert told_lines({"inner": options}) == [f"inner.{line}"]
    assert told_lines({"many": [{}, options]}) == [f"many.1.{line}"]


def test_a_table_is_asked_for_in_words():
    assert told_lines({"inner": 3}) == ["inner: must be a table. Got 3."]


def test_a_list_is_asked_for_in_words():
    assert told_lines({"many": 3}) == ["many: must be a list. Got 3."]


def test_an_empty_list_is_too_short():
    assert told_lines({"many": []}) == ["many: has too few entries: at least 1. Got []."]


def test_a_long_list_is_too_long():
    assert told_lines({"many": [{}, {}, {}]})[0].startswith("many: has too many entries: at most 2. Got [{}")


def test_a_list_of_faulty_entries_is_not_called_too_short():
    assert told_lines({"many": [{"size": 0}]}) == ["many.0.size: must be at least 1. Got 0."]


def test_a_missing_field_shows_an_example():
    assert told_lines({}, Needy) == [
        'wanted: is required and missing. Write wanted = "this".',
        "plain: is required and missing.",
    ]


def test_all_faults_are_told():
    assert len(told_lines({"inner": {"size": 0, "word": "up"}, "many": [], "else": 1})) == 4


def test_braces_in_a_text_survive():
    error = raised([fault(("a", 0), "write {type = 'x'}", 1)])

    assert lines(error, Outer) == ["a.0: write {type = 'x'}"]


def test_a_fault_of_the_whole_has_no_path():
    assert lines(raised([fault((), "all wrong")]), Outer) == ["all wrong"]


def test_a_told_error_tells_the_same_again():
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate({"inner": {"sise": 3}, "many": []})

    once = told(caught.value, Outer)

    assert lines(once, Needy) == lines(caught.value, Outer)


def test_a_long_value_is_cut():
    assert len(shown(list(range(1000)))) == LONGEST


def test_a_far_word_has_no_nearest():
    assert nearest("xyzzy", ["affine", "similarity"]) == ""
