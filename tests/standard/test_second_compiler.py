"""Compilers other than gfortran 12 accept the sources.

LLVM's flang checks all of `src` against Fortran 2018, the oldest standard that it knows; gfortran
checks it against 2008. flang generates no code here, and cannot read the HDF5 modules of gfortran:
it reads `hdf5.f90` instead, so it checks calls of HDF5 against that file only. It does not read
`tests`. What flang accepts and gfortran 13 and 14 reject is searched for in the text.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from sources import (
    ROOT,
    bound_procedures,
    checked_subscripts,
    constant_selectors,
    constant_tables,
    eager_selectors,
    in_order,
    late_selectors,
    program_sources,
)

FLANG = "flang-new-19"
STUB = Path(__file__).with_name("hdf5.f90")
PLANTED = {
    "structure constructor lacks a value": """
module planted
   implicit none
   type :: inner_type
      real, allocatable :: values(:)
   end type inner_type
   type :: outer_type
      type(inner_type) :: inner
   end type outer_type
contains
   subroutine reset(outer)
      type(outer_type), intent(out) :: outer
      outer = outer_type()
   end subroutine reset
end module planted
""",
    "is not definable": """
module planted
   implicit none
contains
   pure function total(values) result(sum)
      real, intent(in) :: values(:)
      real :: sum
      integer :: i
      sum = 0.0
      do i = 1, size(values)
         call add(values(i))
      end do
   contains
      pure subroutine add(value)
         real, intent(in) :: value
         sum = sum + value
      end subroutine add
   end function total
end module planted
""",
}   # fmt: skip


def mumps_folder():
    """Where the program's build found the header of MUMPS."""
    cache = Path(os.environ["THERCON"]).parent / "CMakeCache.txt"
    return next(line.split("=", 1)[1] for line in cache.read_text().splitlines()
                if line.startswith("MUMPS_INCLUDE_DIR:"))


def flang(folder, files):
    """Let flang check files: all in one, because it takes 0.3 s to start."""
    if not shutil.which(FLANG):
        pytest.skip(f"needs {FLANG} (flang-19)")
    whole = folder / "whole.f90"
    whole.write_text("".join(f"include '{file}'\n" for file in files))
    command = [FLANG, "-fsyntax-only", "-std=f2018", "-Werror", f"-I{mumps_folder()}", whole]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_flang_accepts_the_program(tmp_path):
    files = in_order([*program_sources(), STUB])
    read = flang(tmp_path, files)
    assert read.returncode == 0, read.stderr
    assert len(list(tmp_path.glob("*.mod"))) == len(files) - 1   # all but the main program


@pytest.mark.parametrize("complaint", PLANTED)
def test_flang_refuses_what_gfortran_12_overlooks(complaint, tmp_path):
    planted = tmp_path / "planted.f90"
    planted.write_text(PLANTED[complaint])
    read = flang(tmp_path, [planted])
    assert read.returncode != 0
    assert complaint in read.stderr.lower()


def test_cmake_accepts_another_compiler_with_a_warning(tmp_path):
    assert flang(tmp_path, [STUB]).returncode == 0
    configure = ["cmake", "-G", "Ninja", "-S", ROOT, "-B", tmp_path / "build",
                 f"-DCMAKE_Fortran_COMPILER={FLANG}", "-DBUILD_TESTING=OFF"]
    told = subprocess.run(configure, capture_output=True, text=True, check=False)
    assert told.returncode != 0
    assert f"{FLANG} cannot read" in told.stderr
    told = subprocess.run([*configure, f"-DFortranHDF5_INCLUDE_DIR={tmp_path}"],
                          capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    assert "thercon is tested with gfortran only" in told.stderr


def test_no_associate_statement_calls_a_function_defined_further_down():
    # gfortran 13 and 14 do not know the type of the result yet.
    found = {str(file): late for folder in ("src", "tests/unit")
             for file in (ROOT / folder).rglob("*.*") if file.suffix in (".f90", ".pf")
             if (late := late_selectors(file.read_text()))}
    assert not found


def test_no_subscript_of_an_associate_statement_calls_what_gfortran_14_resolves_too_early():
    bound = bound_procedures(file.read_text() for file in program_sources())
    assert "at_point" in bound["point_materials_type"]
    found = {str(file): early for folder in ("src", "tests/unit")
             for file in (ROOT / folder).rglob("*.*") if file.suffix in (".f90", ".pf")
             if (early := eager_selectors(file.read_text(), bound))}
    assert not found


def test_no_associate_statement_takes_an_element_of_a_constant_table():
    # gfortran 12 compares components of the first element in place of those of the one asked for.
    tables = constant_tables(file.read_text() for file in program_sources())
    assert "quantities" in tables
    found = {str(file): names for folder in ("src", "tests/unit")
             for file in (ROOT / folder).rglob("*.*") if file.suffix in (".f90", ".pf")
             if (names := constant_selectors(file.read_text(), tables))}
    assert not found


def test_no_argument_of_matmul_has_a_subscript_that_gfortran_14_checks_before_it_is_set():
    found = {str(file): lines for folder in ("src", "tests/unit")
             for file in (ROOT / folder).rglob("*.*") if file.suffix in (".f90", ".pf")
             if (lines := checked_subscripts(file.read_text()))}
    assert not found


def test_such_subscripts_are_found_in_arguments_alone():
    text = """
   a = 2*matmul(e(:, min(g, n)), matmul(b, c)) + e(:, min(g, n))
   a = matmul(max(b, c), &
      matmul(d, e(:, 1 + max(g, 1))))
   a = matmul(e(:, n), max(b(1), 2))
"""
    assert checked_subscripts(text) == [2, 3]


def test_elements_of_constant_tables_are_found_in_continued_statements():
    text = """
   type(quantity_type), parameter :: table(*) = [first, second]
   associate (one => item%table(1), &
      another => Table(i))
   end associate
"""
    assert constant_selectors(text, constant_tables([text])) == [(3, "table")]


def test_functions_further_down_are_found_in_continued_statements():
    text = """
   associate (first => early(1), &
      second => table(late(2)), third => item%late(3))
   end associate
contains
   pure integer function late(i)
   end function late
"""
    assert late_selectors("function early(i)\nend function early\n" + text) == [(4, "late")]


def test_calls_that_gfortran_14_resolves_too_early_are_found_in_subscripts_alone():
    """gfortran 14 rejects the selectors of lines 18 and 19 and accepts those of line 20."""
    text = """
   type, extends(parent) :: points_type
      integer :: first(2)
   contains
      procedure :: place
   end type points_type
   type :: parent
   contains
      procedure, private :: one, at => other
   end type parent
contains
   pure function ends(i) result(k)
   end function ends
   subroutine show(points, sides, table)
      class(points_type), intent(in) :: points
      type(points_type), intent(in) :: sides
      integer, intent(in) :: table(:)
      associate (a => table(points%place(1)), b => table(points%at(1)))
      associate (c => table(1, sides%place(ends(1))))
      associate (d => points%at(1), e => table(sides%place(1)), f => table(points%first(1)), &
         g => sides%place(ends(1)), h => table(ends(1)))
"""
    assert eager_selectors(text, bound_procedures([text])) == [
        (18, "place"), (18, "at"), (19, "ends")]
