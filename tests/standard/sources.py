"""The Fortran sources: their order of compilation, and what they do that some compilers refuse."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FUNCTION = re.compile(r"^(?!\s*end\b)[\w\s(),=*%:]*\bfunction\s+(\w+)\s*\(", re.I)
ASSOCIATE = re.compile(r"\s*(?:\w+\s*:)?\s*associate\s*\(", re.I)


def program_sources():
    """The files of the program; CMake fills in the last one."""
    return [*sorted((ROOT / "src").rglob("*.f90")), ROOT / "src/core/version.f90.in"]


def in_order(files):
    """Order files so that each stands behind the modules that it uses."""
    text = {file: file.read_text().lower() for file in files}
    home = {name: file for file in files
            for name in re.findall(r"^module (\w+)\s*$", text[file], re.M)}
    ordered = []

    def add(file):
        if file in ordered:
            return
        for name in re.findall(r"^\s*use\s*(?:,\s*\w+\s*::)?\s*(\w+)", text[file], re.M):
            if home.get(name, file) is not file:
                add(home[name])
        ordered.append(file)

    for file in files:
        add(file)
    return ordered


def statements(text):
    """Yield line numbers, from 1, and statements: without comments, continued lines in one."""
    start, statement = 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        line = line.split("!")[0].rstrip()
        start = start or number
        statement += line.lstrip("& ") if statement else line
        if statement.endswith("&"):
            statement = statement[:-1]
        else:
            yield start, statement
            start, statement = 0, ""


def constant_selectors(text, tables):
    """Find ASSOCIATE statements with an element of a constant table: (line, table)."""
    return [(number, name) for number, statement in statements(text) if ASSOCIATE.match(statement)
            for name in re.findall(r"=>\s*(\w+)\s*\(", statement.lower()) if name in tables]


def constant_tables(texts):
    """Names of constant arrays of derived type."""
    return {name.lower() for text in texts for name in
            re.findall(r"^\s*type\s*\(\w+\),\s*parameter\s*::\s*(\w+)\s*\(", text, re.M | re.I)}


def late_selectors(text):
    """Find ASSOCIATE statements that call a function defined further down: (line, function)."""
    listed = list(statements(text))
    defined = {match[1].lower(): number for number, statement in listed
               if (match := FUNCTION.match(statement))}
    return [(number, name) for number, statement in listed if ASSOCIATE.match(statement)
            for name in re.findall(r"(?<![%\w])(\w+)\s*\(", statement.lower())
            if defined.get(name, 0) > number]


def bound_procedures(texts):
    """Names of the procedures bound to each type, those of its parents included."""
    own, parents = {}, {}
    for text in texts:
        name = ""
        for _, statement in statements(text.lower()):
            if match := re.match(r"\s*type\b(?!\s*\()(.*)::\s*(\w+)", statement):
                name = match[2]
                own[name] = set()
                parents[name] = next(iter(re.findall(r"extends\s*\((\w+)\)", match[1])), None)
            elif name and (match := re.match(r"\s*procedure\b.*::(.*)", statement)):
                own[name] |= set(re.findall(r"(?:^|,)\s*(\w+)", match[1]))
            elif re.match(r"\s*end\s*type\b", statement):
                name = ""

    def of(name):
        return own[name] | of(parents[name]) if name in own else set()

    return {name: of(name) for name in own}


def eager_selectors(text, bound):
    """Find calls in subscripts of selectors of ASSOCIATE that gfortran 14 resolves too early: of a
    procedure bound to a CLASS variable, or of a function of the file for an argument of another:
    (line, name)."""
    found, classes, functions = [], {}, set()
    for number, statement in statements(text.lower()):
        if match := FUNCTION.match(statement):
            functions.add(match[1])
        if re.match(r"[\w\s(),=*]*\b(?:function|subroutine)\s+\w+", statement):
            classes = {}
        if match := re.match(r"\s*class\s*\((\w+)\).*?::(.*)", statement):
            classes |= dict.fromkeys(re.findall(r"\w+", match[2]), match[1])
        if not ASSOCIATE.match(statement):
            continue
        for match in re.finditer(r"(?<![%\w])(\w+)(?:%(\w+))?\s*\(", statement):
            before = statement[:match.start()]
            depth = before.count("(") - before.count(")")
            if match[2] in bound.get(classes.get(match[1]), ()) and depth > 1:
                found.append((number, match[2]))
            if not match[2] and match[1] in functions and depth > 2:
                found.append((number, match[1]))
    return found


def checked_subscripts(text):
    """Lines of statements in which an argument of MATMUL has a subscript that calls MIN or MAX."""
    found = set()
    for number, statement in statements(text.lower()):
        for match in re.finditer(r"\bmatmul\s*\(", statement):
            depth, name = 1, ""
            for word in re.findall(r"\w+|\S", statement[match.end():]):
                depth += (word == "(") - (word == ")")
                if depth == 0:
                    break
                if word == "(" and name in ("min", "max") and depth > 2:
                    found.add(number)
                name = word
    return sorted(found)
