"""Each distribution in `plugins/`, once installed, is listed, explained, checked and run by name."""

import io
import sys
import tomllib
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import regframe
from regframe.cli.main import run
from regframe.testing.phantoms import visual_thermal

BRIEFLY = ("--no-figures", "--no-verdict")  # three iterations find nothing, which a verdict would say
PLUGINS = Path(__file__).resolve().parents[1] / "plugins"


def told(*words: str) -> str:
    """What a regframe command says, in this process; whatever goes wrong ends the script."""
    sys.stdout.write(f"$ regframe {' '.join(words)}\n")
    sys.stdout.flush()
    with redirect_stdout(io.StringIO()) as said:
        code = run(words)
    if code:
        sys.exit(f"{said.getvalue()}it ended with {code}")
    return said.getvalue()


@cache
def listed(plural: str) -> list[str]:
    """The lines of a list."""
    return told("list", plural).splitlines()


def use(kind: str, name: str, preset: str, frames: list[str], out: Path) -> None:
    """Ask for a component and its preset in every way there is."""
    for plural, each in ((f"{kind}s", name), ("presets", preset)):
        lines = listed(plural)
        if not any(line.startswith(f"{each} ") and "unusable" not in line for line in lines):
            sys.exit(f"{each} is not listed among the {plural}:\n" + "\n".join(lines))
    told("check", kind, name)
    told("explain", name)
    told("explain", preset)
    short = [
        f"stages.{i}.levels.{j}.iterations=3"
        for i, stage in enumerate(regframe.load_preset(preset).stages)
        for j in range(len(stage.levels))
    ]
    settings = [word for each in short for word in ("--set", each)]
    told("register", *frames, "--preset", preset, "--out", str(out), *BRIEFLY, *settings)


def main() -> None:
    """Go through the distributions."""
    with TemporaryDirectory() as folder:
        street, frames = visual_thermal(1, (120, 160)), []
        for image, name in ((street.fixed, "visual.png"), (street.moving, "thermal.png")):
            frames.append(str(Path(folder) / name))
            regframe.write(image.raw, image.grid, frames[-1])
        for file in sorted(PLUGINS.glob("*/pyproject.toml")):
            points = tomllib.loads(file.read_text(encoding="utf-8"))["project"]["entry-points"]
            (preset,) = points.pop("regframe.preset")
            ((group, (name,)),) = points.items()
            use(group.removeprefix("regframe."), name, preset, frames, Path(folder) / name)


main()
