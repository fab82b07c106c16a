"""Code in the documents runs, page by page, and links lead somewhere.

A page is read from top to bottom in a folder that holds two frames, `visual.png` and `thermal.png`:
Python blocks share one namespace, TOML blocks are presets, console blocks call `regframe`.
"""

import re
import shlex
import sys
from pathlib import Path
from types import ModuleType

import pytest

from house.pages import Block, blocks, pages
from house.source import REPOSITORY
from regframe.catalog import KINDS

LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)")
WITH_CODE = [page for page in pages() if any(block.reason is None for block in blocks(page))]


def named(page: Path) -> str:
    return page.relative_to(REPOSITORY).as_posix()


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    """A folder with a visual and a thermal frame, small ones so that pages run quickly."""
    from regframe import write
    from regframe.testing.phantoms import visual_thermal

    folder = tmp_path_factory.mktemp("frames")
    street = visual_thermal(seed=1, shape=(120, 160))
    for name, image in (("visual.png", street.fixed), ("thermal.png", street.moving)):
        write(image.raw, image.grid, folder / name)
    return folder


@pytest.fixture
def folder(frames, tmp_path, monkeypatch):
    """A page's own copy of the frames, as the working folder; names it registers are taken back."""
    for file in frames.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    before = {kind: set(registry.names()) for kind, registry in KINDS.items()}
    yield tmp_path
    for kind, registry in KINDS.items():
        for name in set(registry.names()) - before[kind]:
            registry.forget(name)


def run(block: Block, namespace: dict[str, object], folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Do what a reader would do with a block."""
    if block.file:
        (folder / block.file).write_text(block.code, encoding="utf-8")
    if block.language == "python":
        exec(compile(block.code, f"line {block.line}", "exec"), namespace)
    elif block.language == "toml":
        _load(block, folder)
    elif block.language == "console":
        for line in re.findall(r"^\$ ((?:.*\\\n)*.+)", block.code, re.MULTILINE):
            _call(shlex.split(line.replace("\\\n", " ")), monkeypatch)
    else:
        pytest.fail(f"line {block.line}: a {block.language} block needs a reason for not being run")


def _load(block: Block, folder: Path) -> None:
    from regframe.preset import load

    file = folder / (block.file or "block.toml")
    file.write_text(block.code, encoding="utf-8")
    assert load(file).stages


def _call(words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    from regframe.cli.main import main

    assert words[0] == "regframe"
    monkeypatch.setattr(sys, "argv", words)
    try:
        code = main()
    except SystemExit as end:
        code = end.code
    assert code in (None, 0), " ".join(words)


@pytest.mark.parametrize("page", WITH_CODE, ids=named)
def test_code_runs(page, folder, monkeypatch):
    module = ModuleType("page")
    monkeypatch.setitem(sys.modules, "page", module)  # pickle looks classes up by their module's name

    for block in blocks(page):
        if block.reason is None:
            run(block, vars(module), folder, monkeypatch)


@pytest.mark.parametrize("page", [*pages(), *(REPOSITORY / "plugins").rglob("README.md")], ids=named)
def test_links_lead_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))

    broken = [link for link in links if not (page.parent / link).exists()]

    assert broken == []
