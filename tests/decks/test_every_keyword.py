"""Every keyword and parameter of docs/deck has a test that runs decks with two values of it, and a
refused deck with a bad value of each. The index, docs/deck.md, has every keyword."""

import importlib
import re

from deck_runs import DECKS, run

INDEX = DECKS.parents[1] / "docs" / "deck.md"
CHAPTERS = [path for path in sorted((INDEX.parent / "deck").glob("*.md"))
            if path.stem != "other_programs"]
FLAGS = {"GENERATE", "DIRECT", "PRESSURE", "CLEARANCE", "ROUGH", "ADD", "REMOVE", "SHRINK",
         "READ", "WRITE", "OVERLAY", "SHIFT", "FIXED",
         "REFLECT"}
VALUES = {"GAP LAW, CLEARANCE"}   # no flag there, but a value of TYPE=

# What has one value only, or none.
ONE_VALUE = {
    "END STEP": "no data, no parameter",
    "CHANGE FRICTION": "no data",
    "MODEL CHANGE, TYPE": "CONTACT PAIR is the only one",
    "CONTACT INTERFERENCE, TYPE": "CONTACT PAIR is the only one",
    "SURFACE, TYPE": "each type has data of its own",
    "AMPLITUDE, VALUE": "RELATIVE is the only one",
    "BOUNDARY, TYPE": "DISPLACEMENT is the only one",
    "NSET, ELSET": "stands in the section of both",
    "ELSET, NSET": "stands in the section of both",
    "ELSET, SURFACE": "stands in the section of both",
    "GAP CONDUCTANCE, DEPENDENCIES": "refused",
    "PLASTIC, DATA TYPE": "PARAMETERS has data of its own",
    "PLASTIC, NUMBER BACKSTRESSES": "1 is the only one",
    "PART": "no data", "END PART": "no data", "ASSEMBLY": "no data", "END ASSEMBLY": "no data",
    "ASSEMBLY, NAME": "means nothing", "END INSTANCE": "no data",
    "RIGID BODY": "no data", "RIGID BODY, POSITION": "INPUT is the only one",
    "CYCLE": "no data", "COUPLING": "no data", "COUPLING, CONSTRAINT NAME": "means nothing",
    "ELCOPY": "no data", "CLEARANCE": "no data", "CONTINUATION": "no data",
    "FIXED POINT": "no data", "INCLUDE": "no data",
    "MATERIAL": "no data", "OPTIONS": "no data", "PHYSICAL CONSTANTS": "no data",
    "REFINE": "no data", "RESTART": "no data", "SOLVER": "no data",
    "STABILITY": "no data",
    "STEP": "no data", "SURFACE INTERACTION": "its thickness is not needed",
}


def sections():
    """Return the keywords and the text of each section of the reference that describes cards."""
    text = "\n".join(path.read_text() for path in CHAPTERS).replace("\\*", "*")
    for part in re.split(r"^##? ", text, flags=re.M)[1:]:
        title, _, body = part.partition("\n")
        yield re.findall(r"\*([A-Z][A-Z -]+)", title), body


def described():
    """Return every keyword and every parameter, as `KEYWORD` and `KEYWORD, PARAMETER`."""
    found = set()
    for keywords, body in sections():
        mentioned = re.findall(r"\*([A-Z][A-Z -]*[A-Z])\b", body)
        found |= {keyword.strip() for keyword in [*keywords, *mentioned]}
        owners = keywords or [k for k in mentioned if k.endswith(("FILE", "PRINT"))]
        for line in body.splitlines():
            # A row that begins with a keyword tells of its parameters; so do the rows behind it.
            row = re.match(r"\| \*([A-Z -]+) \|", line)
            owners = [row[1]] if row else owners
            for span in re.findall(r"`([^`]+)`", line):
                if span.startswith(("*", "--")):   # of another card, of the command line
                    continue
                names = re.findall(r"([A-Z][A-Z -]*?)=", span) + [f for f in FLAGS if f == span]
                found |= {f"{owner.strip()}, {name}" for owner in owners for name in names}
    return found - VALUES


def covered():
    """Return what the tests of decks are marked with: `@pytest.mark.changes(...)`."""
    found = set()
    for path in DECKS.glob("test_*.py"):
        for item in vars(importlib.import_module(path.stem)).values():
            for mark in getattr(item, "pytestmark", []):
                marks = [mark]
                if mark.name == "parametrize":
                    marks = [m for case in mark.args[1] for m in getattr(case, "marks", ())]
                found.update(card for m in marks if m.name == "changes" for card in m.args)
    return found


def test_the_index_has_every_keyword():
    listed = re.findall(r"^\*([A-Z][A-Z-]*(?: [A-Z-]+)*)", run("--keywords").stdout, re.M)
    index = INDEX.read_text().split("\n## ")[1]
    linked = re.findall(r"\[\\\*([A-Z -]+)\]\(deck/\w+\.md#", index)
    assert len(listed) > 90
    assert linked == sorted(listed)


def test_every_keyword_and_parameter_is_tested_in_two_values():
    known = described()
    assert {"FILM, FILM AMPLITUDE", "ELASTIC, TYPE", "NODE FILE, FREQUENCY", "STATIC, DIRECT",
            "GAP LAW", "FIXED POINT, G", "VERIFY", "CONTACT PRINT, FREQUENCY"} <= known
    missing = known - covered() - ONE_VALUE.keys()
    assert not missing, f"no test runs decks with two values of: {sorted(missing)}"


def test_what_is_said_to_have_one_value_is_described():
    assert ONE_VALUE.keys() <= described()


def test_tests_name_what_the_reference_describes():
    unknown = covered() - described()
    assert not unknown, f"docs/deck does not describe: {sorted(unknown)}"


def refused():
    """Return the keywords and parameters at whose cards, and fields, refused decks have errors."""
    found = set()
    for path in sorted((DECKS / "refused").glob("*.expected")):
        for name, line, column in re.findall(r"^(\S+?):(\d+):(\d+): error", path.read_text(),
                                             flags=re.M):
            lines = (DECKS / "refused" / name).read_text(errors="replace").splitlines()[:int(line)]
            cards = [card for card in lines if re.match(r"\*[^*]", card)]
            if not cards:
                continue
            keyword = " ".join(cards[-1].split(",")[0][1:].upper().split())
            found.add(keyword)
            if cards[-1] is lines[-1]:
                place = lines[-1][:int(column)].count(",")
                parameter = lines[-1].split(",")[place].partition("=")[0].strip().upper()
                found.add(f"{keyword}, {parameter}")
    return found


def test_every_keyword_and_parameter_has_a_refused_deck():
    missing = described() - refused() - {"NSET, ELSET", "ELSET, NSET", "ELSET, SURFACE"}
    assert not missing, f"no refused deck has an error at: {sorted(missing)}"
