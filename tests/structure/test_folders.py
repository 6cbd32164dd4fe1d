"""The folders of src: a module uses only modules of its own folder and of those above it."""

import re
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[2] / "src"
# In the order in which data flow; folders of one line know nothing of each other.
ORDER = (
    ("core",), ("linalg",), ("laws",), ("model",), ("division",), ("fem",),
    ("deck/reading",), ("deck/checking",), ("deck/building",),
    ("contact",), ("bodies",), ("coupling",), ("records",), ("stepping",), ("accuracy",),
    ("stability",),
    ("adaptivity",), ("output",), ("run",), ("trade",), ("driver",), (".",),
)
RANK = {folder: rank for rank, folders in enumerate(ORDER) for folder in folders}
MODULE = re.compile(r"^\s*module\s+(\w+)\s*$", re.MULTILINE)
PRINTS = re.compile(r"^\s*(?:print\b|write\s*\(\s*(?:\*|\d|output_unit|error_unit))", re.MULTILINE)
USE = re.compile(r"^\s*use\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*(\w+)", re.MULTILINE)


def folder_of(path, root=SOURCES):
    """Return the folder of a file below src."""
    return path.parent.relative_to(root).as_posix()


def modules(root=SOURCES):
    """Return the folder of every module below a folder."""
    return {found[1].lower(): folder_of(path, root) for path in root.rglob("*.f90")
            if (found := MODULE.search(path.read_text()))}


def forbidden_uses(root=SOURCES):
    """Return the uses that the order does not allow, in words."""
    folders, wrong = modules(root), []
    for path in sorted(root.rglob("*.f90")):
        own = folder_of(path, root)
        for used in map(str.lower, USE.findall(path.read_text())):
            its = folders.get(used)
            if its is not None and its != own and RANK[its] >= RANK[own]:
                wrong.append(f"{own}/{path.name} uses {used} of {its}")
    return wrong


def doors(folder, inside):
    """Return the modules of a folder that its README calls doors."""
    text = (SOURCES / folder / "README.md").read_text().split("Doors, ")[1].split("Reference")[0]
    named = set(re.findall(r"`(\w+)`", text)) & inside
    return inside - named if "may use: all" in text else named


@pytest.mark.parametrize("folder", sorted({name.split("/")[0] for name in RANK} - {"."}))
def test_other_folders_use_the_doors_of_a_folder_alone(folder):
    """Those that its README names, and all of these."""
    owner = {name: its.split("/")[0] for name, its in modules().items()}
    inside = {name for name, its in owner.items() if its == folder}
    used = {name.lower() for path in SOURCES.rglob("*.f90")
            if folder_of(path).split("/")[0] != folder for name in USE.findall(path.read_text())}
    assert used & inside == doors(folder, inside)


def test_two_modules_alone_print():
    """What a trace of the numerics leaves behind would be among the messages of a run."""
    found = {path.stem for path in SOURCES.rglob("*.f90") if PRINTS.search(path.read_text())}
    assert found == {"messages", "progress"}


def test_every_folder_stands_in_the_order():
    assert set(modules().values()) | {"."} == set(RANK)


def test_modules_use_only_folders_above_theirs():
    assert forbidden_uses() == []


@pytest.mark.parametrize(("folder", "used", "is_wrong"), [
    ("linalg", "kinds", False), ("linalg", "dense", False), ("fem", "listing", True),
    ("core", "dense", True), ("deck/reading", "deck_checks", True), ("trade", "main_flow", True)])
def test_a_use_of_a_folder_below_is_found(tmp_path, folder, used, is_wrong):
    """In a tree of its own, so that the test above is known to be able to fail."""
    where = {"kinds": "core", "dense": "linalg", "listing": "output",
             "deck_checks": "deck/checking", "main_flow": "driver"}[used]
    for name, text in ((f"{where}/{used}.f90", f"module {used}\nend module {used}\n"),
                       (f"{folder}/own.f90", f"module own\n   use {used}, only: a\nend module own\n")):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert bool(forbidden_uses(tmp_path)) is is_wrong
