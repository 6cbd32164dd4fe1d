"""What the page takes from the listing of the run: outcome, why it ended early, checks, warnings."""

import re
from dataclasses import dataclass, field
from itertools import takewhile

# card, kind, quantity, where, time, expected, found, deviation, allowed, kind of it, verdict
CHECK = re.compile(
    r"^ *(\d+)  (.{10}) (.{24,}?) (.{16})(.{11})(.{15})(.{15})(.{10})(.{10}) (REL|ABS) +(PASS|FAIL|-)$"
)
REMARK = re.compile(r"^ {8}(source|failed|no value|found): +(.*)$")
FOUND = re.compile(r"\S+(?: \+- ([^\s,]+)| \(no estimate(?:: (.*?))?\))?(?:, node (\d+))?$")
ITEM = re.compile(r"^   - (.*)$")
ANALYSIS = re.compile(r"^   stability: (\w+)")
POINTER = re.compile(r"(;[^;]*)?, (?:or )?see ENDED EARLY.*$")


@dataclass
class Check:
    """One *VERIFY check, in the words of the listing."""

    card: str
    kind: str
    quantity: str
    where: str
    time: str
    expected: str
    found: str
    deviation: str
    allowed: str
    measure: str
    verdict: str
    source: str = ""
    failed: str = ""  # why, or why there is no value
    uncertainty: str = ""
    no_estimate: str | None = None  # why there is none, if that is told
    node: str = ""  # of a set


@dataclass
class Listing:
    """The parts of a listing."""

    outcome: str = ""
    ended_early: str = ""  # why, and what the results hold
    accuracy: list = field(default_factory=list)  # whether a requested one is reached, and its targets
    checks: list = field(default_factory=list)
    warnings: list = field(default_factory=list)
    stability: dict = field(default_factory=dict)  # increment -> whether its state lasts


def read_listing(path, cards):
    """Return the Listing at `path`; None where there is none, or it is not of the deck `cards`."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return None
    if deck_of(lines) != [card.rstrip() for card in cards]:
        return None
    summary = [line.strip() for line in section(lines, "SUMMARY")]
    ended = [line.strip() for line in section(lines, "ENDED EARLY")]
    # Why, then a sentence on the results, and one on each attempt.
    words = re.sub(r"\.? (The results|No increment|attempt \d+ of size) ",
                   lambda begin: f". {begin[1][0].upper()}{begin[1][1:]} ", " ".join(takewhile(bool, ended)))
    found = Listing(ended_early=words)
    # The page tells the reason beside the outcome; without one a later round is being solved.
    found.outcome = POINTER.sub("" if ended else r"\1", next((line for line in summary if line), ""))
    for line in section(lines, "VERIFICATION", underlined=False):
        check, remark = CHECK.match(line), REMARK.match(line)
        if check:
            found.checks.append(Check(*(part.strip() for part in check.groups())))
        elif remark and found.checks:
            add_remark(found.checks[-1], *remark.groups())
    found.warnings = items(section(lines, "WARNINGS"))
    found.stability = analyses(lines)
    # The table of rounds is set off from the targets.
    found.accuracy = items(takewhile(str.strip, section(lines, "REQUESTED ACCURACY")))
    return found


def add_remark(check, name, words):
    """Add to a check what a line below it says."""
    if name != "found":
        setattr(check, "source" if name == "source" else "failed", words)
    elif told := FOUND.match(words):
        check.uncertainty, check.no_estimate, check.node = told[1] or "", told[2], told[3] or ""


def analyses(lines):
    """Return whether states last, each in a word such as stable, by the numbers of increments."""
    found, number = {}, 0
    for line in lines:
        increment, words = re.match(r"^INCREMENT (\d+) ", line), ANALYSIS.match(line)
        number = int(increment[1]) if increment else number
        if words:
            found[number] = words[1]
    return found


def items(lines):
    """Return the items of a list, which may go on below their first lines."""
    found = []
    for line in lines:
        item = ITEM.match(line)
        if item:
            found.append(item.group(1))
        elif line.strip() and found:
            found[-1] += " " + line.strip()
    return found


def section(lines, title, underlined=True):
    """Return the lines below a title of the listing, up to the next title."""
    starts = [k for k, line in enumerate(lines) if line == title]
    if not starts:
        return []
    found = []
    for line in lines[starts[-1] + 1 + underlined :]:
        if re.match(r"^[A-Z]", line):
            break
        found.append(line)
    return found


def deck_of(lines):
    """Return the card images of the listing; wide ones go on below, ENDED EARLY may follow."""
    starts = [k for k, line in enumerate(lines) if line == "DECK"]
    cards = []
    for line in lines[starts[-1] + 2 :] if starts else ():
        if line[:1].strip():
            break
        if line[:8].strip():
            cards.append(line[10:])
        elif cards:
            cards[-1] += line[10:]
    return [card.rstrip() for card in cards]
