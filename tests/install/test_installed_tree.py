"""What `cmake --install` copies works, without the sources and the folder of the build."""

import os
import re
import sys
from pathlib import Path

import h5py
import pytest
from commands import PROGRAM, ROOT, run

SOURCES_ONLY = re.compile(r"(?:\.\./)?(?:src/|tests/|CONTRIBUTING\.md)")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", PROGRAM.parent, "--prefix", folder)
    return folder


@pytest.fixture(scope="module")
def result(prefix, tmp_path_factory):
    """The result of an installed deck, solved by the installed program."""
    folder = tmp_path_factory.mktemp("results")
    run(prefix / "bin/thercon", "run", "--quiet", prefix / "share/thercon/input/hertz/hertz.inp",
        "--out", folder, cwd=folder)
    return folder / "hertz.vtkhdf"


def libraries(program):
    """Paths of the shared libraries that a program loads, without their addresses."""
    return {line.split(" (")[0].strip() for line in run("ldd", program).splitlines()}


def test_an_installed_deck_runs(result):
    with h5py.File(result) as file:
        assert file["run"].attrs["verify_passed"] > 0
        assert file["run"].attrs["verify_failed"] == 0


def test_installed_scripts_draw_and_compare(prefix, result):
    post = prefix / "share/thercon/post"
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    run(post / "plot", "mesh", result, "--out", result.parent, env=environment)
    assert (result.parent / "hertz.mesh.png").stat().st_size > 1000
    run(post / "report", result, "--out", result.parent, env=environment)
    run(post / "compare", result, result, "--out", result.parent, env=environment)


def test_the_installed_program_loads_the_libraries_of_the_build(prefix):
    assert libraries(prefix / "bin/thercon") == libraries(PROGRAM)


def test_all_decks_scripts_and_documents_are_installed(prefix):
    def files(root, *names):
        found = [path for name in names for path in [root / name, *(root / name).rglob("*")]
                 if path.is_file() and "__pycache__" not in path.parts]
        return {path.relative_to(root): (os.access(path, os.X_OK), path.read_bytes())
                for path in found}

    installed = files(prefix / "share/thercon", ".")
    assert installed == files(ROOT, "input", "post", "python", "docs", "README.md", "CHANGELOG.md",
                              "CITATION.cff", "LICENSE")
    assert not any(str(ROOT).encode() in content for _, content in installed.values())


def test_links_of_the_installed_documents_lead_to_installed_files(prefix):
    broken = {(document.name, link) for document in (prefix / "share/thercon").rglob("*.md")
              for link in re.findall(r"\]\((?!http)([^)#\s]+)", document.read_text())
              if not SOURCES_ONLY.match(link) and not (document.parent / link).exists()}
    assert not broken
