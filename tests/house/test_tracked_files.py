"""What is committed is small, finished, and names no machine."""

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

from house.source import REPOSITORY

LARGEST_BYTES = 1_000_000
TEXT = {".cff", ".css", ".html", ".md", ".py", ".toml", ".txt", ".yaml", ".yml", ""}

MACHINE = re.compile(
    r"(?<![\w.$}/-])/(?:home|root|work|opt|Users|mnt|private)/\w"
    r"|[A-Z]:\\\\?Users"
    r"|\bfile:/{2}"
    r"|\b(?:10|127|192\.168|172\.(?:1[6-9]|2\d|3[01]))(?:\.\d{1,3}){2,3}\b"
    r"|--(?:extra-)?index-[u]rl|--find-[l]inks"
    r"|https?://[\w.-]*\.(?:internal|local|lan|corp)\b"
)


@cache
def tracked() -> list[Path]:
    """Files under version control."""
    git = shutil.which("git")
    if git is None or not (REPOSITORY / ".git").exists():
        pytest.skip("this is no git checkout, so nobody can say which files belong to it")
    listing = [git, "-C", str(REPOSITORY), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    run = subprocess.run(listing, capture_output=True, text=True, check=True)
    return [REPOSITORY / name for name in run.stdout.split("\0") if name and (REPOSITORY / name).is_file()]


def texts() -> list[tuple[str, str]]:
    """Name and content of every text file."""
    found = [path for path in tracked() if path.suffix in TEXT and path.name != "LICENSE"]
    return [(str(path.relative_to(REPOSITORY)), path.read_text(encoding="utf-8")) for path in found]


def test_no_file_names_a_machine():
    met = {name: found[0] for name, text in texts() if (found := MACHINE.search(text))}

    assert met == {}


def test_no_file_is_large():
    large = {path.name: path.stat().st_size for path in tracked() if path.stat().st_size > LARGEST_BYTES}

    assert large == {}


def test_text_files_end_with_a_line_break():
    ragged = [name for name, text in texts() if text and not text.endswith("\n")]

    assert ragged == []
