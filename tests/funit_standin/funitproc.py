"""Stand-in for pFUnit's preprocessor: a test source (.pf) becomes Fortran.

Known are @test, @before, @after and the assertions of the module funit, each on a line of its own.
Test sources are modules named as their file. The module is followed by a subroutine that runs its
tests, for the driver to call.
"""

import re
import sys
from pathlib import Path

ASSERTIONS = (
    "Equal",
    "RelativelyEqual",
    "True",
    "False",
    "LessThan",
    "GreaterThan",
    "IsNaN",
    "IsFinite",
)
ASSERTION = re.compile(rf"\s*@assert({'|'.join(ASSERTIONS)})\s*\((.*\S.*)\)\s*$", re.IGNORECASE)
MARK = re.compile(r"\s*@(test|before|after)\s*$", re.IGNORECASE)
MODULE = re.compile(r"\s*module\s+(\w+)\s*$", re.IGNORECASE)
SUBROUTINE = re.compile(r"\s*subroutine\s+(\w+)\s*(\(\s*\))?\s*(!.*)?$", re.IGNORECASE)

ASSERTION_CODE = """\
# {line} "{path}"
      call assert{kind}({arguments}, &
         location=sourcelocation("{name}", {line}))
      if (anyexceptions()) return
# {next_line} "{path}"
"""
SUITE_CODE = """
subroutine {module}_suite()
   use funit, only: run_test
   use {module}
   implicit none

{calls}
end subroutine {module}_suite
"""


class SourceError(Exception):
    """What is wrong with a test source, as path:line: error: text."""


def convert(text, path):
    """Return the Fortran source for the test source `text`, read from `path`."""
    module, mark, before, after = None, None, "", ""
    tests, output = [], [f'# 1 "{path}"\n']

    def refuse(reason):
        raise SourceError(f"{path}:{number}: error: {reason}")

    for number, line in enumerate(text.splitlines(), start=1):
        code = line.strip()
        if not code or code.startswith("!"):
            output.append(line + "\n")
        elif match := ASSERTION.match(line):
            output.append(
                ASSERTION_CODE.format(
                    line=number,
                    next_line=number + 1,
                    path=path,
                    name=path.name,
                    kind=match[1],
                    arguments=match[2],
                )
            )
        elif match := MARK.match(line):
            if mark:
                refuse(f"@{mark} is not followed by its subroutine")
            mark = match[1].lower()
            output.append("\n")
        elif code.startswith("@"):
            refuse("not an annotation that is known here, or not on one line")
        else:
            if match := MODULE.match(line):
                module = match[1]
            elif mark:
                match = SUBROUTINE.match(line)
                if not match:
                    refuse(f"@{mark} is not followed by its subroutine")
                if mark == "test":
                    tests.append(match[1])
                elif mark == "before":
                    before = f", before={match[1]}"
                else:
                    after = f", after={match[1]}"
                mark = None
            output.append(line + "\n")

    number = 1
    if not module or module.lower() != path.stem.lower():
        refuse(f"a test source is a module named as its file: {path.stem}")
    if not tests:
        refuse("no @test in this file")
    calls = "\n".join(
        f'   call run_test("{module}_suite.{test}", &\n      {test}{before}{after})'
        for test in tests
    )
    return "".join(output) + SUITE_CODE.format(module=module, calls=calls)


def main():
    """Convert the files named into ones of the folder named first; what does not change stays as it
    is, so that it is not compiled again."""
    folder = Path(sys.argv[1])
    try:
        for source in map(Path, sys.argv[2:]):
            target, text = folder / f"{source.stem}.f90", convert(source.read_text(), source)
            if not target.exists() or target.read_text() != text:
                target.write_text(text)
    except SourceError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
