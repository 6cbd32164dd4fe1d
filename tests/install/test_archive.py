"""The archive of `cpack -G TGZ` runs from a folder to which it was moved, where no package of its
libraries is installed."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import h5py
import pytest
from commands import PROGRAM, ROOT, run

OF_THE_C_LIBRARY = re.compile(r"ld-linux|lib(c|m)\.so|linux-vdso")


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """The folder of the archive, moved to another one."""
    folder = tmp_path_factory.mktemp("archive")
    run("cpack", "-G", "TGZ", "--config", PROGRAM.parent / "CPackConfig.cmake", "-B", folder)
    (archive,) = folder.glob("*.tar.gz")
    assert re.fullmatch(r"thercon-[\d.]+-linux-\w+\.tar\.gz", archive.name)
    run("tar", "--directory", folder, "--extract", "--file", archive)
    shutil.rmtree(folder / "_CPack_Packages")
    (folder / "root/opt").mkdir(parents=True)
    return (folder / archive.name.removesuffix(".tar.gz")).rename(folder / "root/opt/moved")


def loaded(program):
    """The libraries that a program loads in an empty environment: {name: path}."""
    lines = run("ldd", program, env={"PATH": os.environ["PATH"]}).splitlines()
    found = [re.match(r"\s*(\S+)(?: => (.*))? \(", line) or line for line in lines]
    return {match[1]: match[2] or match[1] for match in found}


def test_all_libraries_but_those_of_the_c_library_are_in_the_archive(moved):
    others = {name: path for name, path in loaded(moved / "bin/thercon").items()
              if not OF_THE_C_LIBRARY.search(name)}
    assert len(others) > 5
    assert {Path(path).resolve().parent for path in others.values()} == {moved / "lib/thercon"}
    assert not any(OF_THE_C_LIBRARY.search(path.name) for path in (moved / "lib/thercon").iterdir())


def test_a_deck_is_solved_where_there_is_nothing_but_the_c_library(moved):
    root = moved.parents[1]
    if os.geteuid() != 0 or subprocess.run(["unshare", "--mount", "true"], check=False).returncode:
        pytest.skip("needs root, and mounts of its own")
    for name, path in loaded(moved / "bin/thercon").items():
        if OF_THE_C_LIBRARY.search(name) and "vdso" not in name:
            (root / path[1:]).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, root / path[1:])
    (root / "proc").mkdir()   # by which a program finds its own folder
    deck = "/opt/moved/share/thercon/input/hertz/hertz.inp"
    run("unshare", "--mount", "sh", "-c", 'mount -t proc proc "$1/proc" && exec chroot "$@"', "sh", root,
        "/opt/moved/bin/thercon", "run", "--quiet", deck, "--out", "/results")
    with h5py.File(root / "results/hertz.vtkhdf") as file:
        assert file["run"].attrs["verify_passed"] > 0 and file["run"].attrs["verify_failed"] == 0


def test_the_citation_has_the_version_and_the_authors_of_the_program():
    citation = (ROOT / "CITATION.cff").read_text()
    version = run(PROGRAM, "--version").split()[1].rstrip(",")
    assert re.search(r"^version: (.*)$", citation, re.M)[1] == version
    authors = re.search(r"Copyright \(c\) \d+ (.*)", (ROOT / "LICENSE").read_text())[1]
    assert re.search(r"^authors:\n  - name: (.*)$", citation, re.M)[1] == authors
