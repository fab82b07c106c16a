from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given
from hypothesis import strategies as st

from regframe.catalog import METRICS
from regframe.errors import PresetError
from regframe.preset import Level, Preset, Stage, as_toml, differences, dump, load, parse, save
from regframe.preset.paths import paths
from support.stubs import Stub

NUMBERS = st.floats(min_value=-1e9, max_value=1e9)
POSITIVE = st.floats(min_value=1e-9, max_value=1e9)
# TOML has no surrogates, and reads "\r\n" as "\n".
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


@st.composite
def levels(draw: st.DrawFn) -> Level:
    sampling = draw(st.sampled_from(["all", "regular", "random"]))
    share = st.floats(min_value=0.0, max_value=1.0, exclude_min=True)
    return Level(
        shrink=draw(st.integers(1, 16)),
        smooth=draw(st.floats(min_value=0.0, max_value=100.0)),
        iterations=draw(st.integers(1, 10**6)),
        sampling=sampling,
        fraction=1.0 if sampling == "all" else draw(share),
    )


METRIC = st.builds(
    Stub,
    bins=st.integers(5, 500),
    pair=st.tuples(NUMBERS, NUMBERS).map(sorted).map(tuple),
    mode=st.sampled_from(["soft", "hard"]),
    limit=st.none() | NUMBERS | st.just(float("inf")),
)
STAGE = st.builds(
    Stage,
    name=TEXTS,
    start=st.sampled_from(["centres", "identity", "moments", "fields-of-view"]),
    transform=st.sampled_from(["translation", "rigid", "similarity", "affine"]),
    interpolator=st.just("linear") | st.integers(0, 5).map(lambda order: {"type": "bspline", "order": order}),
    metric=METRIC,
    optimizer=st.just("one-plus-one"),
    scales=st.sampled_from(["shift", "physical-shift", "index-shift", "jacobian"])
    | st.lists(POSITIVE, min_size=1, max_size=6).map(tuple),
    gradient=st.sampled_from(["exact", "filtered", "central"]),
    levels=st.lists(levels(), min_size=1, max_size=3).map(tuple),
)
PRESET = st.builds(
    Preset,
    name=TEXTS.filter(len),
    about=TEXTS,
    seed=st.integers(1, 2**32 - 1),
    stages=st.lists(STAGE, min_size=1, max_size=3).map(tuple),
)


@pytest.fixture(autouse=True, scope="module")
def stub():
    """A metric by name."""
    METRICS.register("stub")(Stub)
    yield
    METRICS.forget("stub")


@given(PRESET)
def test_parse_takes_back_what_dump_gives(preset):
    assert parse(dump(preset)) == preset


@given(PRESET)
def test_load_takes_back_what_save_writes(preset):
    with TemporaryDirectory() as folder:
        path = Path(folder) / "preset.toml"
        save(preset, path)

        assert load(path) == preset


@given(PRESET)
def test_toml_is_the_same_after_a_round_trip(preset):
    text = as_toml(preset)

    with TemporaryDirectory() as folder:
        path = Path(folder) / "preset.toml"
        path.write_bytes(text.encode())

        assert as_toml(load(path)) == text


@given(PRESET, PRESET)
def test_differences_are_none_only_between_equal_presets(a, b):
    assert differences(a, a) == []
    assert (differences(a, b) == []) == (a == b)


@given(PRESET, PRESET)
def test_differences_turn_round(a, b):
    there = differences(a, b)

    assert differences(b, a) == [(path, new, old) for path, old, new in there]


@given(PRESET, PRESET)
def test_differences_as_overrides_lead_from_one_to_the_other(a, b):
    a, b = (load(each, {"stages": dump(each)["stages"][:1]}) for each in (a, b))
    a, b = (load(each, {"stages.0.levels": dump(each)["stages"][0]["levels"][:1]}) for each in (a, b))

    assert load(a, {path: new for path, _, new in differences(a, b)}) == b


@given(PRESET, st.data())
def test_every_path_can_be_set_to_what_is_there(preset, data):
    tree = dump(preset)
    path = data.draw(st.sampled_from(sorted(paths(tree))))
    node = tree
    for key in path.split("."):
        node = node[int(key)] if isinstance(node, list) else node[key]

    assert load(preset, {path: node}) == preset


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)


def refusal(preset: Preset, path: str, value: object) -> str | None:
    """What is said against a value, if anything."""
    try:
        load(preset, {path: value})
    except PresetError as error:
        return str(error)
    return None


@given(PRESET, JUNK, st.data())
def test_junk_is_taken_or_refused_with_its_path(preset, junk, data):
    path = data.draw(st.sampled_from(sorted(paths(dump(preset)))))

    text = refusal(preset, path, junk)

    # Some values are judged with what holds them: a component's type, one of several scales.
    assert text is None or path.rpartition(".")[0] in text


@given(
    st.dictionaries(st.sampled_from(["name", "about", "seed", "filters", "stages", "extends", "a.b"]), JUNK)
)
def test_a_tree_of_junk_is_a_preset_error(tree):
    with pytest.raises(PresetError):
        parse(tree)
