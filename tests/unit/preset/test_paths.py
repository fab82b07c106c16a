import pytest

from regframe.errors import PresetError
from regframe.metrics.mean_squares import MeanSquares
from regframe.preset import Level, differences, load
from regframe.preset.paths import paths
from support.stubs import Same


def faults(base, overrides: dict) -> list[str]:
    """Lines after the one that names the preset."""
    with pytest.raises(PresetError) as caught:
        load(base, overrides)
    title, *lines = str(caught.value).splitlines()
    assert title == "preset 'base' with overrides:"
    return lines


def test_an_override_changes_a_value_and_nothing_else(base):
    changed = load(base, {"stages.0.metric.bins": 8})

    assert differences(base, changed) == [("stages.0.metric.bins", 32, 8)]


def test_an_override_replaces_a_whole_list(base):
    changed = load(base, {"stages.0.levels": [{"shrink": 4}]})

    assert changed.stages[0].levels == (Level(shrink=4),)


def test_an_override_replaces_a_component(base):
    changed = load(base, {"stages.0.metric": "mean-squares"})

    assert changed.stages[0].metric == MeanSquares()


def test_an_override_reaches_options_of_a_component_given_by_name(base):
    changed = load(base, {"stages.0.metric": "stub", "stages.0.metric.bins": 9})

    assert changed.stages[0].metric.bins == 9


def test_an_override_reaches_options_of_a_filter_given_by_name(base):
    changed = load(base, {"filters.fixed": ["stub"], "filters.fixed.0.amount": 2.0})

    assert changed.filters.fixed == (Same(amount=2.0),)


def test_a_text_is_not_taken_for_a_component(base):
    (line,) = faults(base, {"stages.0.start.here": 3})

    assert line.startswith("stages.0.start.here: there is no such path.")


def test_another_type_drops_the_old_options(base):
    changed = load(base, {"stages.0.metric.type": "grid-stub"})

    assert changed.stages[0].metric.bins == 50


def test_the_same_type_keeps_the_options(base):
    assert load(base, {"stages.0.metric.type": "stub"}) == base


def test_an_override_appends_after_the_last(base):
    changed = load(base, {"stages.0.levels.2": {"iterations": 7}})

    assert changed.stages[0].levels == (*base.stages[0].levels, Level(iterations=7))


def test_an_appended_stage_continues(base):
    added = {"transform": "affine", "interpolator": "linear", "metric": "stub", "optimizer": "one-plus-one"}

    changed = load(base, {"stages.1": added})

    assert changed.stages[1].start == "previous"


def test_overrides_are_applied_in_order(base):
    changed = load(base, {"stages.0.levels": [{}], "stages.0.levels.0.shrink": 3})

    assert changed.stages[0].levels == (Level(shrink=3),)


def test_combinations_are_checked_after_the_last_override(base):
    changed = load(base, {"stages.0.levels.0.fraction": 0.5, "stages.0.levels.0.sampling": "random"})

    assert changed.stages[0].levels[0].fraction == 0.5


@pytest.mark.parametrize(
    ("path", "near"),
    [
        ("stage.0.metric.bins", "Did you mean 'stages.0.metric.bins'?"),
        ("stages.0.metrc.bins", "Did you mean 'stages.0.metric.bins'?"),
        ("stages.1.metric.bins", "Did you mean 'stages.0.metric.bins'?"),
        ("stages.0.levels.7.shrink", "Did you mean 'stages.0.levels."),
        ("qqq.zzz", "`regframe preset show` prints all of them."),
    ],
)
def test_a_path_that_leads_nowhere_is_told_with_the_nearest(base, path, near):
    (line,) = faults(base, {path: 3})

    assert line.startswith(f"{path}: there is no such path. {near}")


def test_a_list_is_not_extended_past_its_end(base):
    (line,) = faults(base, {"stages.0.levels.5": {}})

    assert line.endswith("It has 2; write 2 to add one.")


@pytest.mark.parametrize("path", ["stages.0.metric.bns", "sed", "stages.0.levels.0.shrnk", "filters.fixd"])
def test_an_unknown_last_key_is_told_with_the_known_ones(base, path):
    (line,) = faults(base, {path: 3})

    assert line.startswith(f"{path}: unknown option. Did you mean ")


def test_all_faults_of_overrides_are_told(base):
    overrides = {"stages.0.metrc.bins": 3, "seed": 0, "stages.0.transform": "afine"}

    assert [line.partition(":")[0] for line in faults(base, overrides)] == [
        "stages.0.metrc.bins",
        "seed",
        "stages.0.transform",
    ]


def test_overrides_leave_the_preset_as_it_was(base):
    load(base, {"seed": 99, "stages.0.levels.2": {}})

    assert base.seed == 3
    assert len(base.stages[0].levels) == 2


def test_equal_presets_do_not_differ(base):
    assert differences(base, load(base, {"stages.0.metric": {"type": "stub", "bins": 32}})) == []


def test_added_and_removed_entries_differ_from_nothing(base):
    shorter = load(base, {"stages.0.levels": [{"shrink": 2, "smooth": 1.5}]})

    ((path, old, new),) = differences(base, shorter)

    assert (path, new) == ("stages.0.levels.1", None)
    assert old["shrink"] == 1
    assert differences(shorter, base) == [(path, new, old)]


def test_a_component_of_another_type_is_one_difference(base):
    ((path, old, new),) = differences(base, load(base, {"stages.0.metric": "mean-squares"}))

    assert path == "stages.0.metric"
    assert old["bins"] == 32
    assert new == {"type": "mean-squares"}


def test_a_list_of_numbers_differs_as_a_whole(base):
    scaled = load(base, {"stages.0.scales": [1, 2, 3, 4]})

    assert differences(scaled, load(scaled, {"stages.0.scales": [1, 2, 3, 5]})) == [
        ("stages.0.scales", [1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 5.0])
    ]


def test_paths_come_parents_first():
    assert list(paths({"a": [{"b": 1}], "c": 2})) == ["a", "a.0", "a.0.b", "c"]
