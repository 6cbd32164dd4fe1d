"""CMake takes what it is told, and the shared libraries of HDF5 unless archives are asked for."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def configure(folder, *arguments):
    """Configure in a new folder; return the commands of the build."""
    command = ["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DBUILD_TESTING=OFF", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return (folder / "build.ninja").read_text()


@pytest.fixture(scope="module")
def default(tmp_path_factory):
    return configure(tmp_path_factory.mktemp("default"))


def test_flags_of_the_release_are_those_named(default, tmp_path):
    assert "FLAGS = -Og -ffrontend-optimize -g1 -ffp-contract=off" in default
    assert re.search("FLAGS = -Og .* -O3$", default, re.M)   # kernels
    named = configure(tmp_path, "-DCMAKE_Fortran_FLAGS_RELEASE=-O2 -g",
                      "-DCMAKE_C_FLAGS_RELEASE=-O2")
    assert "FLAGS = -O2 -g " in named
    assert not any(f"-O{level}" in named for level in (0, 1, 3))
    assert "-ffp-contract" not in named


def test_shared_libraries_of_hdf5_are_preferred(default):
    assert "/libhdf5_fortran.so" in default
    assert "/libhdf5.so" in default
    assert "hdf5.a" not in default


def test_archives_of_hdf5_are_linked_where_that_is_asked_for_and_works(tmp_path):
    shared, archive = "/libhdf5_fortran.so", "/libhdf5_fortran.a"
    asked = configure(tmp_path / "asked", "-DFortranHDF5_PREFER_ARCHIVES=ON")
    works = "FortranHDF5_ARCHIVES_LINK:INTERNAL=1" in (tmp_path / "asked/CMakeCache.txt").read_text()
    assert (archive in asked) == works and (shared in asked) != works
    failing = configure(tmp_path / "failing", "-DFortranHDF5_PREFER_ARCHIVES=ON",
                        "-DFortranHDF5_ARCHIVES_LINK=NO")
    assert shared in failing and archive not in failing


def test_the_program_looks_for_no_library_in_the_working_folder(default):
    """An empty entry of the path stands for that folder."""
    paths = re.findall(r'-Wl,-rpath,"?([^\s"]*)', default)
    entries = [entry for path in paths for entry in path.split(":")]
    assert all(Path(entry).is_absolute() or "$ORIGIN/" in entry for entry in entries), paths
    assert paths
