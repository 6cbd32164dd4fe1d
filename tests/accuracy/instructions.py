"""Instructions of a run by callgrind, and how many of them a part of the program's source takes."""

import os
import re
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

PROGRAM = os.environ.get("THERCON", "thercon")
SOURCES = Path(__file__).resolve().parents[2] / "src"
BEGIN = re.compile(r"^\s*(?:(?:pure|elemental|recursive|impure|module|\w+\(.*?\)|logical|integer|character)"
                   r"\s+)*(?:subroutine|function)\s+(\w+)", re.I)
END = re.compile(r"^\s*end\s+(?:subroutine|function)\b", re.I)


@cache
def procedures(module):
    """Return the procedure that each line of a module belongs to, inner ones by their host."""
    names, inside = [""], []
    for line in next(SOURCES.rglob(f"{module}.f90")).read_text().splitlines():
        if (begins := BEGIN.match(line)) and not END.match(line):
            inside.append(begins[1].lower())
        names.append(inside[0] if inside else "")
        if END.match(line):
            inside.pop()
    return names


@cache
def place(file, line):
    """Return module and procedure of a line of source, or of no source of ours."""
    path = Path(file)
    if path.suffix != ".f90" or SOURCES not in path.parents:
        return "", ""
    names = procedures(path.stem)
    return path.stem, names[line] if line < len(names) else ""


@dataclass(frozen=True)
class Profile:
    """Instructions of a run: all, those of each place, and those of calls between two places; and how
    often each place is called from elsewhere."""

    total: int
    own: dict
    calls: dict
    called: dict

    def share(self, names):
        """Return the part of all instructions that is spent in these modules (`name`) and
        procedures (`module:name`), with what they call outside of themselves."""

        def is_in(where):
            return where[0] in names or ":".join(where) in names

        spent = sum(cost for where, cost in self.own.items() if is_in(where))
        spent += sum(cost for (source, target), cost in self.calls.items()
                     if is_in(source) and not is_in(target))
        return spent / self.total


def profile(*arguments, path):
    """Run the program under callgrind, which writes to a path; return the profile."""
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={path}", PROGRAM,
               *map(str, arguments)]
    process = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert process.returncode == 0, process.stderr
    return read(path)


def instructions(*arguments):
    """Run the program; return how many instructions that takes, without their places, which takes
    less time."""
    command = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
               PROGRAM, *map(str, arguments)]
    process = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert process.returncode == 0, process.stderr
    counted = re.search(r"I\s+refs:\s+([\d,]+)", process.stderr)
    return int(counted[1].replace(",", ""))


def read(path):
    """Read a file of callgrind, whose names and lines are told by what stands before them."""
    names, own, calls, called = {}, {}, {}, {}
    total = line = often = 0
    home = at = to = ""  # the file of a function, of a line (it may be inlined) and of a call
    target = None
    for text in path.read_text().splitlines():
        if named := re.match(r"(fl|fi|fe|cfi|cfl)=(\(\d+\))(?: (.*))?", text):
            kind, key, name = named.groups()
            file = names.setdefault(key, name)
            at, to = (at, file) if kind.startswith("c") else (file, file)
            home = file if kind == "fl" else home
        elif text.startswith("fn="):
            at = to = home
        elif text.startswith("summary:"):
            total = int(text.split()[1])
        elif text.startswith("calls="):
            often, target = int(text[6:].split()[0]), moved(line, text.split()[1])
        elif re.match(r"[\d+*-]", text):
            position, cost = text.split()
            line = moved(line, position)
            where = place(at, line)
            if target is not None:
                between = where, place(to, target)
                calls[between] = calls.get(between, 0) + int(cost)
                called[between[1]] = called.get(between[1], 0) + often
                target, to = None, at
            else:
                own[where] = own.get(where, 0) + int(cost)
    return Profile(total, own, calls, called)


def moved(line, position):
    """Return the number of a line that is told from the one before."""
    if position == "*":
        return line
    return line + int(position) if position[0] in "+-" else int(position)
