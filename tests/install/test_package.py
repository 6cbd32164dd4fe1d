"""The Debian package, the Python package, the manual page and the completion of bash."""

import os
import re
import shutil
import sys
import tomllib
from pathlib import Path

import h5py
import pytest
from commands import PROGRAM, ROOT, run

HERTZ = "share/thercon/input/hertz/hertz.inp"


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """The Debian package of the build."""
    folder = tmp_path_factory.mktemp("package")
    run("cpack", "--config", PROGRAM.parent / "CPackConfig.cmake", "-B", folder)
    (found,) = folder.glob("*.deb")
    return found


@pytest.fixture(scope="module")
def root(package, tmp_path_factory):
    """An empty root with what the package installs."""
    folder = tmp_path_factory.mktemp("root")
    run("dpkg-deb", "--extract", package, folder)
    return folder / "usr"


def test_the_package_declares_what_it_needs(package):
    depends = run("dpkg-deb", "--field", package, "Depends")
    names = {re.match(r"[^ (|]+", each.strip())[0] for each in depends.split(",")}
    assert names >= {"python3", "python3-h5py", "python3-matplotlib", "libopenblas0-serial"}
    linked = run("readelf", "-d", PROGRAM)
    for library, name in (("hdf5", "libhdf5"), ("dmumps", "libmumps"), ("metis", "libmetis"),
                          ("gfortran", "libgfortran")):
        assert f"lib{library}" not in linked or any(each.startswith(name) for each in names), name


def test_a_deck_is_solved_and_its_page_written_from_an_empty_root(root, tmp_path):
    """The other programs draw in test_installed_tree.py."""
    run(root / "bin/thercon", "run", "--quiet", root / HERTZ, "--out", tmp_path, cwd=tmp_path)
    with h5py.File(tmp_path / "hertz.vtkhdf") as file:
        assert file["run"].attrs["verify_passed"] == 12 and file["run"].attrs["verify_failed"] == 0
    environment = {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    result = tmp_path / "hertz.vtkhdf"
    for name in ("plot", "compare"):
        assert "usage: " in run(root / f"bin/thercon-{name}", "--help", env=environment)
    run(root / "bin/thercon-report", result, "--out", tmp_path, env=environment)
    assert (tmp_path / "hertz.html").exists()


def test_the_manual_page_says_what_help_says(root):
    """As the program prints it, but for signs that the page writes in another way."""
    page = (root / "share/man/man1/thercon.1").read_text()
    shown = page.replace("\\-", "-").replace("\\\\", "\\")
    for line in run(PROGRAM, "--help").removeprefix("usage: ").splitlines():
        assert line in shown
    assert re.findall(r"^\.SH (.*)", page, re.M) == \
        ["NAME", "SYNOPSIS", "COMMANDS", "OPTIONS", "EXIT STATUS", "SEE ALSO"]


@pytest.mark.parametrize(("words", "offered"), [
    (["thercon", ""], {"run", "check", "trade"}),
    (["thercon", "t"], {"trade"}),
    (["thercon", "run", "--acc"], {"--accuracy"}),
    (["thercon", "--k"], {"--keywords"}),
    (["thercon", "check", "--js"], {"--json"}),
    (["thercon", "run", "deck.i"], {"deck.inp"}),
])
def test_bash_completes_commands_options_and_files(root, tmp_path, words, offered):
    (tmp_path / "deck.inp").touch()
    script = (f"source {root}/share/bash-completion/completions/thercon; COMP_WORDS=({' '.join(words[:-1])}"
              f" '{words[-1]}'); COMP_CWORD={len(words) - 1}; _thercon thercon '{words[-1]}';"
              "printf '%s\\n' \"${COMPREPLY[@]}\"")
    path = f"{root}/bin:{os.environ['PATH']}"
    said = run("bash", "-c", script, cwd=tmp_path, env=os.environ | {"PATH": path})
    assert set(said.split()) == offered


@pytest.fixture
def site(root, tmp_path):
    """Package and program where `pip install --target` copies them; the wheel itself takes a
    compilation."""
    shutil.copytree(root / "share/thercon/python/thercon", tmp_path / "site/thercon")
    (tmp_path / "site/bin").mkdir()
    shutil.copy(root / "bin/thercon", tmp_path / "site/bin/thercon")
    return tmp_path / "site"


def test_the_python_package_works_without_the_sources(site, tmp_path):
    paths = os.pathsep.join([str(site), *filter(None, sys.path)])
    environment = {key: value for key, value in os.environ.items() if key != "THERCON"} | {
        "PYTHONPATH": paths}
    code = (f"import thercon; assert thercon.find_program() == {str(site / 'bin/thercon')!r}\n"
            f"print(thercon.run({str(ROOT / 'input/examples/two_rods.inp')!r}).outcome)")
    assert run(sys.executable, "-c", code, env=environment, cwd=tmp_path) == "solved\n"
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    assert set(scripts) == {"thercon-plot", "thercon-report", "thercon-compare"}
    code = "import sys, thercon.post.cli, thercon.post.report.cli, thercon.post.comparison.cli\n"
    for entry in scripts.values():
        code += f"try: {entry.replace(':', '.')}()\nexcept SystemExit: pass\n"
    assert run(sys.executable, "-c", code, "--help", env=environment).count("usage: ") == 3
    module, function = scripts["thercon-report"].split(":")
    code = f"import sys; from {module} import {function}; sys.exit({function}())"
    run(sys.executable, "-c", code, "two_rods", "--out", tmp_path, env=environment, cwd=tmp_path)
    assert "color-scheme" in (tmp_path / "two_rods.html").read_text()


def test_the_package_declares_what_it_imports():
    sources = "".join(path.read_text() for path in (ROOT / "python").rglob("*.py"))
    imported = set(re.findall(r"^ *(?:from|import) (\w+)", sources, re.M))
    pinned = {line.split("==")[0] for line in (ROOT / "post/requirements.txt").read_text().split()}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert set(project["dependencies"]) == imported & pinned


def test_the_version_is_that_of_cmake():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    version = project["tool"]["scikit-build"]["metadata"]["version"]
    found = re.search(version["regex"], (ROOT / version["input"]).read_text(), re.M)["value"]
    assert run(PROGRAM, "--version").split()[1].rstrip(",") == found
    assert project["project"]["dynamic"] == ["version"]


def test_help_names_the_programs_of_post_and_the_documents():
    words = run(PROGRAM, "--help")
    for name in ("thercon-plot", "thercon-report", "thercon-compare", "deck.md", "running.md"):
        assert name in words
