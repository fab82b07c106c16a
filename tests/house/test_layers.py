"""Each part of regframe imports only what lies below it."""

import pytest

from house.source import imports, modules

# From the bottom up; a part may import parts of lines above its own, and itself.
LAYERS = (
    ("types", "errors", "faults"),
    ("geometry",),
    ("image",),
    ("io",),
    ("kernels",),
    ("component",),
    ("registry",),
    ("catalog",),
    ("plugins",),
    ("filters", "metrics", "transforms", "interpolators", "optimizers"),
    ("testing", "preset"),
    ("engine",),
    ("verdict",),
    ("peer", "dataset", "report"),
    ("cli",),
)
HEIGHT = {part: height for height, layer in enumerate(LAYERS) for part in layer}
COMPONENTS = LAYERS[HEIGHT["metrics"]]

# Imports against the layers, inside one function each, with the reason.
DOORS = {
    ("regframe.engine.base", "Result.save", "report"): "a result can be saved without knowing who saves",
    ("regframe.engine.base", "Result.verdict", "verdict"): "a result is asked whether to trust it",
    ("regframe.engine.base", "Result._repr_html_", "report"): "notebooks ask the result for its picture",
}


def part_of(module: str) -> str:
    return module.split(".")[1]


def inner_imports(module: str) -> set[tuple[str, str]]:
    """Parts of regframe that a module imports, each with the function it does so in."""
    found = {(part_of(name), within) for name, within in imports(module) if name.startswith("regframe.")}
    return {(part, within) for part, within in found if part != part_of(module)}


INNER = [name for name in modules() if name not in {"regframe", "regframe.__main__"}]


@pytest.mark.parametrize("module", INNER)
def test_imports_only_what_lies_below(module):
    against = {
        (part, within)
        for part, within in inner_imports(module)
        if HEIGHT[part] >= HEIGHT[part_of(module)] and (module, within, part) not in DOORS
    }

    assert against == set()


@pytest.mark.parametrize("module", [name for name in INNER if part_of(name) in COMPONENTS])
def test_a_component_package_imports_no_other(module):
    others = {part for part, _ in inner_imports(module)} & set(COMPONENTS)

    assert others == set()


def test_only_the_command_line_uses_the_phantoms():
    users = {part_of(module) for module in INNER for part, _ in inner_imports(module) if part == "testing"}

    assert users <= {"cli"}


def test_numba_is_imported_in_one_module():
    users = {module for module in modules() for name, _ in imports(module) if name.split(".")[0] == "numba"}

    assert users <= {"regframe.kernels.jit"}


def test_each_door_is_used():
    used = {(module, within, part) for module in INNER for part, within in inner_imports(module)}

    assert DOORS.keys() <= used
