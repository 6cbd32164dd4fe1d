"""Run a test program and compare its verdicts with what its sources say they must be.

    check_verdicts.py PROGRAM SOURCE.pf ...

Every test passes_* must pass and every fails_* must fail, each at an assertion below a comment
"fails here", and each of these must have failed. Reads the output of pFUnit 4 and of the stand-in.
"""

import re
import subprocess
import sys
from pathlib import Path


def expected(sources):
    """Return the sets of all tests, of those that must fail, and of the lines where they do."""
    tests, failing, places = set(), set(), set()
    for source in sources:
        text = source.read_text()
        for name in re.findall(r"^ *@test\n *subroutine (\w+)", text, re.MULTILINE):
            tests.add(f"{source.stem}_suite.{name}")
            if name.startswith("fails_"):
                failing.add(f"{source.stem}_suite.{name}")
        for number, line in enumerate(text.splitlines(), start=1):
            if line.strip() == "! fails here":
                places.add(f"{source.name}:{number + 1}")
    return tests, failing, places


def found(output):
    """Return the sets of the tests that ran to their end, of those that failed, and of the lines."""
    return (
        set(re.findall(r"end: <([^>]+)>", output)),
        set(re.findall(r"Failure in <([^>]+)>", output)),
        set(re.findall(r"^\[([^\]]+:\d+)\]", output, re.MULTILINE)),
    )


def main():
    """Compare, and print what differs."""
    program, sources = sys.argv[1], [Path(name) for name in sys.argv[2:]]
    run = subprocess.run([program, "--verbose"], capture_output=True, text=True, check=False)
    wrong = 0
    for what, must, did in zip(
        ("tests run", "tests failed", "assertions failed"), expected(sources), found(run.stdout)
    ):
        print(f"{what}: {len(did)}")
        for name in sorted(must ^ did):
            wrong += 1
            print(f"   {'missing' if name in must else 'not expected'}: {name}")
    if run.returncode != 2:
        wrong += 1
        print(f"exit status {run.returncode} instead of 2")
    if wrong:
        print(run.stdout, run.stderr, sep="\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
