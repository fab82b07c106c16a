import tomllib
from pathlib import Path

import pytest

from regframe.errors import OutputError, PresetError
from regframe.preset import as_toml, differences, dump, folder, load, names, parse, save, setting
from support.stubs import Stub


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def file(tmp_path, base) -> Path:
    """The preset of the stubs, in a file."""
    return write(tmp_path / "base.toml", as_toml(base))


def fault(source: str | Path) -> str:
    with pytest.raises(PresetError) as caught:
        load(source)
    return str(caught.value)


def test_shipped_presets_are_sorted_and_found_by_name():
    found = names()

    assert found == sorted(found)
    assert {"paper-similarity", "paper-affine", "mono-similarity"} <= set(found)
    assert load("paper-similarity").name == "paper-similarity"


def test_presets_inside_the_package_go_first(tmp_path, monkeypatch):
    package = tmp_path / "regframe"
    monkeypatch.setattr("regframe.preset.finding.__file__", str(package / "preset" / "finding.py"))

    beside = folder()
    (package / "presets").mkdir(parents=True)

    assert beside == tmp_path / "presets"
    assert folder() == package / "presets"


def test_a_file_is_found_by_its_path(file, base, monkeypatch):
    monkeypatch.chdir(file.parent)

    assert load(file) == load(str(file)) == load("base.toml") == load("./base.toml") == base


def test_a_preset_is_loaded_as_it_is(base):
    assert load(base) is base


def test_a_file_is_called_by_its_stem_unless_it_says_otherwise(tmp_path):
    mine = write(tmp_path / "mine.toml", 'extends = "paper-similarity"')

    assert load(mine).name == "mine"


def test_what_a_base_is_about_does_not_hold_for_others(tmp_path):
    mine = write(tmp_path / "mine.toml", 'extends = "paper-similarity"')

    assert load(mine).about == ""


def test_an_unknown_name_is_answered_with_the_nearest():
    message = fault("paper-similarty")

    assert message.startswith(
        "no preset is called 'paper-similarty'. Did you mean 'paper-similarity'? `regframe list presets` "
    )
    assert message.endswith("A file's name ends in .toml.")


def test_a_name_that_is_a_file_without_its_ending_is_told_so(file, monkeypatch):
    monkeypatch.chdir(file.parent)

    assert fault("base").endswith("To read the file, write 'base.toml'.")


def test_a_missing_file_is_answered_with_the_nearest(file):
    message = fault(file.with_name("bass.toml"))

    assert message.endswith("bass.toml'. Did you mean 'base.toml'?")
    assert message.startswith("there is no preset file ")


def test_a_folder_is_no_preset(tmp_path):
    assert "cannot be read" in fault(tmp_path)


def test_a_file_of_bytes_is_no_preset(tmp_path):
    path = tmp_path / "image.toml"
    path.write_bytes(b"\x89PNG\xff\xfe")

    assert fault(path).endswith("A preset is TOML text in UTF-8.")


def test_a_syntax_error_is_told_with_file_line_and_what(tmp_path):
    path = write(tmp_path / "bad.toml", 'name = "bad"\nseed 3\n')

    title, line = fault(path).splitlines()

    assert title == "preset 'bad' (bad.toml) is not TOML:"
    assert line.startswith("line 2, column 6: Expected '='")
    assert line.endswith("Got 'seed 3'.")


def test_a_syntax_error_at_the_end_is_told(tmp_path):
    path = write(tmp_path / "bad.toml", 'name = """bad')

    title, line = fault(path).splitlines()

    assert title == "preset 'bad' (bad.toml) is not TOML:"
    assert line.startswith("at its end: ")


def test_a_key_given_twice_is_told(tmp_path):
    path = write(tmp_path / "bad.toml", "seed = 3\nseed = 4\n")

    assert "line 2" in fault(path)


def test_faults_name_the_preset_and_its_file(tmp_path):
    path = write(tmp_path / "bad.toml", 'name = "mine"\nextends = "paper-similarity"\nsed = 3\nseed = 0\n')

    assert fault(path).splitlines() == [
        "preset 'mine' (bad.toml):",
        "seed: must be at least 1. Got 0.",
        "sed: unknown option. Did you mean 'seed'? Known: name, about, seed, filters, stages.",
    ]


def test_a_file_extends_another_beside_it(file, base):
    mine = write(file.with_name("mine.toml"), 'extends = "base.toml"\n"stages.0.metric.bins" = 8\n')

    changed = differences(base, load(mine))

    assert ("stages.0.metric.bins", 32, 8) in changed
    assert {path for path, _, _ in changed} == {"name", "about", "stages.0.metric.bins"}


def test_a_path_in_extends_starts_at_the_file(file, monkeypatch):
    mine = write(file.parent / "below" / "mine.toml", 'extends = "../base.toml"\nseed = 8\n')
    monkeypatch.chdir("/")

    assert load(mine).seed == 8


def test_extensions_chain(file):
    write(file.with_name("second.toml"), 'extends = "base.toml"\n"stages.0.levels.0.shrink" = 7\n')
    third = write(file.with_name("third.toml"), 'extends = "second.toml"\n"stages.0.levels.0.smooth" = 3.5\n')

    level = load(third).stages[0].levels[0]

    assert (level.shrink, level.smooth) == (7, 3.5)


def test_extending_in_a_circle_is_told(tmp_path):
    for name, other in (("a", "b"), ("b", "c"), ("c", "b")):
        write(tmp_path / f"{name}.toml", f'extends = "{other}.toml"')

    assert fault(tmp_path / "a.toml") == (
        "preset 'b' extends itself: 'b' extends 'c' extends 'b'. Break the circle."
    )


def test_extending_itself_is_told(tmp_path):
    path = write(tmp_path / "a.toml", 'extends = "./a.toml"')

    assert fault(path).startswith("preset 'a' extends itself")


def test_extending_an_unknown_name_is_told_with_the_nearest(tmp_path):
    path = write(tmp_path / "a.toml", 'extends = "paper-afine"')

    title, line = fault(path).splitlines()

    assert title == "preset 'a' (a.toml):"
    assert line.startswith("extends: no preset is called 'paper-afine'. Did you mean 'paper-affine'?")


def test_extending_a_missing_file_is_told(tmp_path):
    path = write(tmp_path / "a.toml", 'extends = "none.toml"')

    assert "there is no preset file" in fault(path)


def test_extending_no_name_is_told(tmp_path):
    path = write(tmp_path / "a.toml", 'extends = ["paper-affine"]')

    assert fault(path).splitlines()[1] == (
        "extends: must be a preset's name or a file in quotes. Got ['paper-affine']."
    )


def test_a_fault_of_the_base_is_told_as_the_bases(file):
    write(file, "seed = 0")
    mine = write(file.with_name("mine.toml"), 'extends = "base.toml"\nseed = 3')

    assert fault(mine).startswith("preset 'base' (base.toml):\nseed: must be at least 1. Got 0.")


def test_a_path_in_a_file_that_leads_nowhere_is_told(tmp_path):
    path = write(tmp_path / "a.toml", 'extends = "paper-affine"\n"stages.0.metrc.bins" = 3')

    assert fault(path).splitlines() == [
        "preset 'a' (a.toml):",
        "stages.0.metrc.bins: there is no such path. Did you mean 'stages.0.metric.bins'?",
    ]


def test_a_key_without_dots_replaces_the_bases(file):
    mine = write(file.with_name("mine.toml"), 'extends = "base.toml"\nstages = []')

    assert "stages: has too few entries" in fault(mine)


def test_the_filters_of_one_image_leave_the_others(file, base):
    mine = write(file.with_name("mine.toml"), 'extends = "base.toml"\nfilters.fixed = ["stub", "stub"]')

    found = load(mine).filters

    assert len(found.fixed) == 2
    assert found.moving == base.filters.moving


def test_a_tree_extends_too():
    assert parse({"extends": "paper-affine", "seed": 4, "stages.0.metric.bins": 9}).stages[0].metric.bins == 9


def test_a_tree_extends_a_file_of_the_working_folder(file, monkeypatch):
    monkeypatch.chdir(file.parent)

    assert parse({"extends": "base.toml"}).stages == load(file).stages


def test_parse_leaves_its_tree_as_it_was(tree):
    before = repr(tree)

    parse({**tree, "stages.0.metric.bins": 9})

    assert repr(tree) == before


def test_toml_says_the_whole_preset(base):
    assert parse(tomllib.loads(as_toml(base))) == base


def test_toml_leaves_out_what_is_none(base):
    assert "limit" in dump(base)["stages"][0]["metric"]
    assert "limit" not in as_toml(base)


def test_toml_cannot_say_nan(base):
    nan = load(base, {"stages.0.metric": Stub(limit=float("nan"))})

    with pytest.raises(PresetError, match="holds a value that TOML cannot say: an option set to None or NaN"):
        as_toml(nan)


def test_a_saved_preset_is_loaded_as_it_was(base, tmp_path):
    save(base, tmp_path / "saved.toml")

    assert load(tmp_path / "saved.toml") == base


def test_saving_refuses_what_is_there(base, file):
    before = file.read_text(encoding="utf-8")

    with pytest.raises(OutputError):
        save(load(base, {"seed": 9}), file)

    assert file.read_text(encoding="utf-8") == before


def test_saving_overwrites_when_told(base, file):
    save(load(base, {"seed": 9}), file, force=True)

    assert load(file).seed == 9


def test_saving_leaves_nothing_else_behind(base, tmp_path):
    save(base, tmp_path / "saved.toml")

    assert [path.name for path in tmp_path.iterdir()] == ["saved.toml"]


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("seed=3", "seed", 3),
        ("a.b = 1.5e-3", "a.b", 1.5e-3),
        ("a=affine", "a", "affine"),
        ('a="affine"', "a", "affine"),
        ("a=[1, 2]", "a", [1, 2]),
        ('a={type = "mattes", bins = 3}', "a", {"type": "mattes", "bins": 3}),
        ("a=x=y", "a", "x=y"),
        ("a=true", "a", True),
    ],
)
def test_a_setting_is_toml_or_plain_text(text, path, value):
    assert setting(text) == (path, value)


@pytest.mark.parametrize("text", ["seed", "=3", "seed=", ""])
def test_a_setting_needs_both_sides(text):
    with pytest.raises(
        PresetError, match=r"a setting is path=value\. Got .* Write stages\.0\.metric\.bins=32"
    ):
        setting(text)


def test_a_setting_of_several_lines_is_text():
    assert setting("about=one\nseed = 3") == ("about", "one\nseed = 3")
