import subprocess
import sys
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import BaseModel, Field, ValidationError

from regframe.catalog import KINDS
from regframe.component import Component
from regframe.errors import PresetError
from regframe.metrics.base import Metric, Pairs
from regframe.registry import Registry
from support.stubs import Plain, Stub

BASE = "regframe.metrics.base:Metric"


@pytest.fixture
def metrics() -> Registry[Metric]:
    """A registry of its own, with two built-in names, whose plugins are of a group nobody uses."""
    return Registry("stub", BASE, {"stub": "support.stubs:Stub", "plain": "support.stubs:Plain"})


def install(folder: Path, distribution: str, entries: dict[str, str], code: str = "") -> None:
    """An installed distribution with entry points of the kind `stub`."""
    info = folder / f"{distribution}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
    points = "\n".join(f"{name} = {place}" for name, place in entries.items())
    (info / "entry_points.txt").write_text(f"[regframe.stub]\n{points}\n")
    (folder / f"{distribution.replace('-', '_')}.py").write_text(code)


GOOD = """
from regframe.metrics.base import Metric

class Shiny(Metric):
    "A metric of a plugin."

    def value(self, pairs):
        return 0.0
"""


@pytest.fixture
def plugins(tmp_path, monkeypatch) -> Path:
    """A folder on the import path; modules imported from it are forgotten afterwards."""
    monkeypatch.syspath_prepend(tmp_path)
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        del sys.modules[name]


def test_listing_names_imports_no_component():
    code = (
        "import sys; from regframe.catalog import KINDS; "
        "names = [registry.names() for registry in KINDS.values()]; "
        "print([name for name in sys.modules if name.startswith('regframe.') and name.count('.') > 1])"
    )

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == "[]"


def test_names_are_sorted(metrics):
    metrics.register("middle")(type("Middle", (Plain,), {"__module__": __name__}))

    assert metrics.names() == ["middle", "plain", "stub"]


def test_a_name_gives_its_class(metrics):
    assert metrics["stub"] is Stub


def test_an_unknown_name_is_answered_with_the_nearest(metrics):
    with pytest.raises(
        PresetError, match=r"^no stub is called 'plian'\. Did you mean 'plain'\? Known: plain, stub\.$"
    ):
        metrics["plian"]


def test_a_far_name_is_answered_with_all_known_ones(metrics):
    with pytest.raises(PresetError, match=r"^no stub is called 'wxyz'\. Known: plain, stub\.$"):
        metrics["wxyz"]


def test_a_registered_class_has_its_name_until_it_is_forgotten(metrics):
    mine = metrics.register("mine")(type("Mine", (Plain,), {"__module__": __name__}))

    found = metrics["mine"]
    metrics.forget("mine")

    assert found is mine
    assert metrics.names() == ["plain", "stub"]


def test_forgetting_an_unknown_name_does_nothing(metrics):
    metrics.forget("nobody")

    assert metrics.names() == ["plain", "stub"]


def test_register_refuses_a_built_in_name(metrics):
    with pytest.raises(
        PresetError, match=r"'stub' is already the name of a stub \(regframe\)\. Choose another"
    ):
        metrics.register("stub")(Plain)


def test_register_refuses_a_name_of_this_session(metrics):
    metrics.register("mine")(type("First", (Plain,), {"__module__": __name__}))

    with pytest.raises(PresetError, match=r"already the name of a stub \(this session\)") as caught:
        metrics.register("mine")(type("Second", (Plain,), {"__module__": __name__}))

    assert "Choose another name" in str(caught.value)


def test_register_takes_a_notebook_cell_that_is_run_again(metrics):
    metrics.register("mine")(type("Same", (Plain,), {"__module__": __name__}))

    again = metrics.register("mine")(type("Same", (Plain,), {"__module__": __name__}))

    assert metrics["mine"] is again


def test_register_refuses_a_class_of_another_kind(metrics):
    class Stranger(Component):
        pass

    with pytest.raises(
        PresetError, match=r"'mine' cannot be a stub: .*Stranger.* does not derive from Metric"
    ):
        metrics.register("mine")(Stranger)


def test_register_refuses_what_is_no_class(metrics):
    with pytest.raises(PresetError, match="does not derive from Metric"):
        metrics.register("mine")(len)


def test_register_refuses_an_option_called_type(metrics):
    class Typed(Plain):
        type: str = Field("x", description="Taken by presets.")

    with pytest.raises(PresetError, match="cannot have an option `type`"):
        metrics.register("mine")(Typed)


def test_messages_use_the_right_article():
    optimizers = Registry("optimizer", "regframe.optimizers.base:Optimizer", {"a": "b:C"})

    with pytest.raises(PresetError, match="an optimizer is a name or a table"):
        optimizers.build(3)


def test_builds_from_a_name(metrics):
    assert metrics.build("stub") == Stub()


def test_builds_from_a_table(metrics):
    assert metrics.build({"type": "stub", "bins": 32, "pair": [1, 2]}) == Stub(bins=32, pair=(1.0, 2.0))


def test_builds_an_instance_as_it_is(metrics):
    mine = Stub(bins=7)

    assert metrics.build(mine) is mine


def test_building_refuses_an_instance_of_another_kind(metrics):
    class Stranger(Component):
        pass

    with pytest.raises(PresetError, match="does not derive from Metric"):
        metrics.build(Stranger())


@pytest.mark.parametrize("config", [4, None, {}, {"bins": 3}, {"type": 3}, ["stub"]])
def test_building_refuses_what_is_no_configuration(metrics, config):
    with pytest.raises(
        PresetError, match=r"a stub is a name or a table with `type`\. Got .* Write .plain. or"
    ):
        metrics.build(config)


def test_an_extra_option_is_answered_with_the_nearest(metrics):
    with pytest.raises(
        PresetError,
        match=r"^stub 'stub': bns: unknown option\. Did you mean 'bins'\? Known: bins, pair, mode, limit\.$",
    ):
        metrics.build({"type": "stub", "bns": 32})


def test_an_extra_option_where_there_are_none_says_so(metrics):
    with pytest.raises(PresetError, match=r"bins: unknown option\. There are none here: remove it\."):
        metrics.build({"type": "plain", "bins": 32})


def test_every_fault_of_a_component_is_told(metrics):
    with pytest.raises(PresetError) as caught:
        metrics.build({"type": "stub", "bins": 2, "mode": "sofd", "pair": [1]})

    assert str(caught.value) == (
        "stub 'stub': bins: must be at least 5. Got 2.; pair.1: is required and missing.; "
        "mode: must be 'soft' or 'hard'. Got 'sofd'. Did you mean 'soft'?"
    )


def test_a_components_own_check_is_told_in_its_own_words(metrics):
    with pytest.raises(
        PresetError, match=r": `pair` must rise\. Got \(3\.0, 1\.0\)\. Write the smaller first\.$"
    ):
        metrics.build({"type": "stub", "pair": [3, 1]})


@pytest.mark.parametrize("bins", ["32", True, 32.5, None])
def test_no_other_type_is_taken_for_a_number(metrics, bins):
    with pytest.raises(PresetError, match=r"bins: must be a whole number\. Got"):
        metrics.build({"type": "stub", "bins": bins})


@pytest.mark.parametrize("limit", [float("inf"), -1.5, 3, None])
def test_dump_and_build_round_trip(metrics, limit):
    mine = Stub(bins=9, pair=(0.1, 0.7), mode="hard", limit=limit)

    assert metrics.build(metrics.dump(mine)) == mine


def test_dump_puts_the_name_first(metrics):
    assert list(metrics.dump(Stub())) == ["type", "bins", "pair", "mode", "limit"]


def test_a_class_without_a_name_is_told_how_to_get_one(metrics):
    class Nameless(Plain):
        pass

    with pytest.raises(PresetError, match=r"Nameless is not a registered stub\. Put @STUBS\.register"):
        metrics.name_of(Nameless())


def test_a_field_takes_what_build_takes(metrics):
    class Holder(BaseModel):
        part: Annotated[Metric, metrics]

    held = Holder.model_validate({"part": {"type": "stub", "bins": 8}})

    assert held.part == Stub(bins=8)
    assert held.model_dump()["part"]["bins"] == 8


def test_a_field_gives_each_fault_its_path(metrics):
    class Holder(BaseModel):
        parts: tuple[Annotated[Metric, metrics], ...]

    with pytest.raises(ValidationError) as caught:
        Holder.model_validate({"parts": ["plian", {"type": "stub", "bins": 2, "mod": 1}]})

    assert [fault["loc"] for fault in caught.value.errors()] == [
        ("parts", 0),
        ("parts", 1, "bins"),
        ("parts", 1, "mod"),
    ]


def test_a_plugin_is_found_by_name(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shiny"}, GOOD)

    assert metrics.names() == ["plain", "shiny", "stub"]
    assert metrics.origin("shiny") == "shiny-metrics"
    assert metrics.build("shiny").value(None) == 0.0
    assert metrics.faults() == {}


def test_a_plugin_is_not_imported_for_its_name(metrics, plugins):
    install(plugins, "broken-metrics", {"broken": "broken_metrics:Broken"}, "raise RuntimeError('no gpu')")

    assert "broken" in metrics.names()
    assert "broken_metrics" not in sys.modules


def test_a_plugins_class_knows_its_name_before_it_is_asked_for(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shiny"}, GOOD)

    import shiny_metrics

    assert metrics.name_of(shiny_metrics.Shiny()) == "shiny"


def test_a_broken_plugin_is_named(metrics, plugins):
    install(plugins, "broken-metrics", {"broken": "broken_metrics:Broken"}, "raise RuntimeError('no gpu')")

    with pytest.raises(PresetError) as caught:
        metrics["broken"]

    assert str(caught.value) == (
        "the stub 'broken' of broken-metrics cannot be imported from broken_metrics:Broken: "
        "RuntimeError: no gpu. Reinstall or remove that plugin."
    )


def test_a_broken_plugin_takes_no_other_down(metrics, plugins):
    install(plugins, "broken-metrics", {"broken": "broken_metrics:Broken"}, "raise RuntimeError('no gpu')")
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shiny"}, GOOD)

    assert list(metrics.faults()) == ["broken (broken-metrics, broken_metrics:Broken)"]
    assert metrics["shiny"].__name__ == "Shiny"
    assert metrics["stub"] is Stub


def test_a_plugin_without_its_class_is_named(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shinny"}, GOOD)

    with pytest.raises(PresetError, match=r"'shiny' of shiny-metrics cannot be imported .* 'Shinny'"):
        metrics["shiny"]


def test_a_plugin_of_another_kind_is_a_fault(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "collections:Counter"})

    (reason,) = metrics.faults().values()

    assert "does not derive from Metric" in reason


def test_a_plugin_does_not_take_a_built_in_name(metrics, plugins):
    install(plugins, "shiny-metrics", {"stub": "shiny_metrics:Shiny"}, GOOD)

    (reason,) = metrics.faults().values()

    assert metrics["stub"] is Stub
    assert reason.startswith("the name 'stub' is taken by regframe")


def test_register_refuses_a_plugins_name(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shiny"}, GOOD)

    with pytest.raises(PresetError, match=r"'shiny' is already the name of a stub \(shiny-metrics\)"):
        metrics.register("shiny")(Plain)


def test_two_plugins_of_one_name_are_both_named(metrics, plugins):
    install(plugins, "shiny-metrics", {"shiny": "shiny_metrics:Shiny"}, GOOD)
    install(plugins, "other-metrics", {"shiny": "other_metrics:Shiny"}, GOOD)

    with pytest.raises(
        PresetError, match=r"'shiny' is claimed by .*-metrics and .*-metrics\. Remove one of them"
    ):
        metrics["shiny"]

    assert len(metrics.faults()) == 2


def test_a_broken_plugin_is_left_out_of_the_schemas(metrics, plugins):
    install(plugins, "broken-metrics", {"broken": "broken_metrics:Broken"}, "raise RuntimeError('no gpu')")

    schemas = metrics.schemas()

    assert schemas["stub"]["anyOf"][0] == {"enum": ["plain", "stub"]}


def test_the_origin_of_an_unknown_name_is_an_error(metrics):
    with pytest.raises(PresetError, match="no stub is called 'nobody'"):
        metrics.origin("nobody")


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_the_catalogue_uses_the_kinds_own_words(kind):
    assert KINDS[kind].kind == kind.removesuffix("s")


def test_a_metric_of_a_script_gets_pairs(metrics):
    @metrics.register("script")
    class Script(Metric):
        def value(self, pairs: Pairs) -> float:
            return float(pairs.weight.sum())

    assert isinstance(metrics.build("script"), Script)
