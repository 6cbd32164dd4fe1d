"""Print which packages of requirements files this Python does not have; fail if there are any."""

import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def is_missing(package):
    try:
        version(package)
    except PackageNotFoundError:
        return True
    return False


if sys.version_info < (3, 11):
    sys.exit(f"this is Python {sys.version.split()[0]}")
packages = [line.split("==")[0] for path in sys.argv[1:] for line in Path(path).read_text().splitlines()
            if line and not line.startswith("#")]
missing = [package for package in packages if is_missing(package)]
if missing:
    sys.exit("missing there: " + ", ".join(missing))
