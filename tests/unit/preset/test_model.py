import pytest
from pydantic import ValidationError

from regframe.errors import PresetError
from regframe.preset import Filters, Level, Preset, Stage, dump, parse
from regframe.transforms.similarity import Similarity
from support.stubs import Stub


def faults(tree: dict) -> list[str]:
    """Lines after the one that names the preset."""
    with pytest.raises(PresetError) as caught:
        parse(tree)
    title, *lines = str(caught.value).splitlines()
    assert title == "preset 'base':"
    return lines


def stage(**options: object) -> dict:
    return {
        "transform": "affine",
        "interpolator": "linear",
        "metric": "stub",
        "optimizer": "one-plus-one",
        **options,
    }


def test_components_are_built(base):
    assert base.stages[0].transform == Similarity()
    assert base.stages[0].metric == Stub(bins=32)


def test_components_may_be_given_as_objects():
    made = Stage(transform=Similarity(), interpolator="linear", metric=Stub(bins=7), optimizer="one-plus-one")

    assert made.metric == Stub(bins=7)


def test_a_level_is_one_full_look_unless_told_otherwise():
    assert Level() == Level(shrink=1, smooth=0.0, iterations=300, sampling="all", fraction=1.0)


def test_a_stage_has_one_full_level_unless_told_otherwise(tree):
    del tree["stages"][0]["levels"]

    assert parse(tree).stages[0].levels == (Level(),)


def test_levels_keep_their_order(base):
    assert [level.shrink for level in base.stages[0].levels] == [2, 1]


def test_the_first_stage_starts_at_the_centres(base):
    assert base.stages[0].start == "centres"


def test_later_stages_continue(tree):
    tree["stages"] += [stage(), stage()]

    assert [each.start for each in parse(tree).stages] == ["centres", "previous", "previous"]


def test_a_later_stage_may_start_anew(tree):
    tree["stages"].append(stage(start="centres"))

    assert parse(tree).stages[1].start == "centres"


def test_the_first_stage_has_nothing_to_continue(tree):
    tree["stages"][0]["start"] = "previous"

    assert faults(tree) == [
        "stages.0.start: the first stage has none before it. Got 'previous'. "
        'Write "centres" or "fields-of-view".'
    ]


def test_a_preset_needs_a_stage():
    with pytest.raises(PresetError, match=r"stages: has too few entries: at least 1\. Got \[\]\."):
        parse({"stages": []})


def test_a_stage_needs_a_level(tree):
    tree["stages"][0]["levels"] = []

    assert faults(tree) == ["stages.0.levels: has too few entries: at least 1. Got []."]


def test_a_missing_component_is_told_with_an_example(tree):
    del tree["stages"][0]["metric"]

    assert faults(tree) == ['stages.0.metric: is required and missing. Write metric = "mattes".']


def test_a_misspelt_component_is_told_with_the_name_meant(tree):
    tree["stages"][0]["transform"] = "similarty"

    (line,) = faults(tree)

    assert line.startswith(
        "stages.0.transform: no transform is called 'similarty'. Did you mean 'similarity'? Known: affine,"
    )


def test_a_misspelt_option_is_told_with_the_option_meant(tree):
    tree["stages"][0]["metric"]["bns"] = 3

    assert faults(tree) == [
        "stages.0.metric.bns: unknown option. Did you mean 'bins'? Known: bins, pair, mode, limit."
    ]


def test_a_misspelt_filter_is_told(tree):
    tree["filters"]["moving"] = ["stub", "invrt"]

    (line,) = faults(tree)

    assert line.startswith("filters.moving.1: no filter is called 'invrt'. Did you mean 'invert'?")


def test_an_unknown_key_is_told_with_the_key_meant(tree):
    tree["stages"][0]["level"] = []

    (line,) = faults(tree)

    assert line.startswith("stages.0.level: unknown option. Did you mean 'levels'? Known: name, start,")


def test_all_faults_are_told_at_once(tree):
    tree["sed"] = 1
    tree["seed"] = "one"
    tree["stages"][0]["metric"] = {"type": "stub", "bins": 1, "mod": 3}
    tree["stages"][0]["optimizer"] = 4
    tree["stages"][0]["levels"] = [{"shrink": 0}, {"iterations": 1.5, "fraction": 20}]

    paths = [line.partition(":")[0] for line in faults(tree)]

    assert paths == [
        "seed",
        "stages.0.metric.bins",
        "stages.0.metric.mod",
        "stages.0.optimizer",
        "stages.0.levels.0.shrink",
        "stages.0.levels.1.iterations",
        "stages.0.levels.1.fraction",
        "sed",
    ]


@pytest.mark.parametrize("fraction", [20, 0, -0.5, float("nan"), 1.0001])
def test_a_fraction_is_a_share(tree, fraction):
    tree["stages"][0]["levels"] = [{"sampling": "random", "fraction": fraction}]

    assert faults(tree) == [
        f"stages.0.levels.0.fraction: must be in (0, 1]. Got {fraction!r}. Write 0.2 for one sample in five."
    ]


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("shrink", 0, "must be at least 1. Got 0."),
        ("shrink", 1.5, "must be a whole number. Got 1.5."),
        ("shrink", True, "must be a whole number. Got True."),
        ("smooth", -1, "must be at least 0. Got -1."),
        ("smooth", float("inf"), "must be a finite number. Got inf."),
        ("smooth", "2", "must be a number. Got '2'."),
        ("iterations", 0, "must be at least 1. Got 0."),
        ("sampling", "randm", "must be 'all', 'regular' or 'random'. Got 'randm'. Did you mean 'random'?"),
    ],
)
def test_a_levels_values_are_checked(tree, option, value, words):
    tree["stages"][0]["levels"] = [{option: value}]

    assert faults(tree) == [f"stages.0.levels.0.{option}: {words}"]


def test_all_samples_and_a_fraction_do_not_go_together(tree):
    tree["stages"][0]["levels"] = [{}, {"fraction": 0.2}]

    assert faults(tree) == [
        'stages.0.levels.1.fraction: has no effect with sampling "all". Got 0.2. '
        'Write sampling = "random" or "regular", or fraction = 1.0.'
    ]


def test_a_metric_of_neighbourhoods_needs_all_samples(tree):
    tree["stages"][0]["metric"] = "grid-stub"
    tree["stages"][0]["levels"] = [{}, {"sampling": "random", "fraction": 0.5}]

    assert faults(tree) == [
        "stages.0.levels.1.sampling: the metric 'grid-stub' needs neighbourhoods, so every grid point. "
        "Got 'random'. Write \"all\"."
    ]


@pytest.mark.parametrize("name", ["shift", "physical-shift", "index-shift", "jacobian"])
def test_scales_may_be_estimated(tree, name):
    tree["stages"][0]["scales"] = name

    assert parse(tree).stages[0].scales == name


def test_scales_may_be_numbers(tree):
    tree["stages"][0]["scales"] = [1, 1, 0.001, 1e-3]

    assert parse(tree).stages[0].scales == (1.0, 1.0, 0.001, 0.001)


@pytest.mark.parametrize("scales", [[], [1, 0], [1, -2.0], [1, "2"], [True], [float("inf")], 3, None])
def test_scales_are_told_in_one_line(tree, scales):
    tree["stages"][0]["scales"] = scales

    assert faults(tree) == [
        "stages.0.scales: must be 'shift', 'grid-shift', 'physical-shift', 'index-shift', 'jacobian' or a "
        f"list of numbers above 0, one a parameter. Got {scales!r}."
    ]


def test_misspelt_scales_are_told_with_the_word_meant(tree):
    tree["stages"][0]["scales"] = "physical_shift"

    (line,) = faults(tree)

    assert line.endswith("Got 'physical_shift'. Did you mean 'physical-shift'?")


@pytest.mark.parametrize("seed", [0, -1, 2**32, 1.0])
def test_a_seed_is_a_whole_number_that_itk_takes_too(tree, seed):
    tree["seed"] = seed

    (line,) = faults(tree)

    assert line.startswith("seed: must be ")


def test_a_preset_is_frozen(base):
    with pytest.raises(ValidationError, match="frozen"):
        base.stages[0].levels[0].shrink = 3


def test_every_field_describes_itself():
    bare = [
        f"{model.__name__}.{name}"
        for model in (Preset, Filters, Stage, Level)
        for name, field in model.model_fields.items()
        if not field.description
    ]

    assert bare == []


def test_dump_writes_every_default_out(base):
    whole = dump(base)

    assert whole["stages"][0]["levels"][1] == {
        "shrink": 1,
        "fit": None,
        "smooth": 0.0,
        "iterations": 300,
        "optimizer": None,
        "carried": False,
        "sampling": "all",
        "fraction": 1.0,
        "refine": None,
    }
    assert whole["stages"][0]["transform"] == {"type": "similarity"}
    assert whole["stages"][0]["interpolator"] == {"type": "bspline", "order": 2}


def test_parse_takes_back_what_dump_gives(tree):
    tree["stages"].append(stage(scales=[1, 2]))
    whole = parse(tree)

    assert parse(dump(whole)) == whole
