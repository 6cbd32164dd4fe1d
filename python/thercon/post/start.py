"""How the programs of `post/` start: in build/venv, or saying what is missing."""

import os
import signal
import sys
from importlib import import_module
from pathlib import Path

from .errors import FAILED

ROOT = Path(__file__).resolve().parents[3]
PYTHON = ROOT / "build" / "venv" / "bin" / "python"


def run(script, module):
    """Run `main` of a module of this package as the program `script`; return its exit status.

    Begins again with the Python of build/venv where that is there, and keeps what it compiles, mostly
    packages, in build/python.
    """
    script = Path(script).resolve()
    if PYTHON.exists():
        if Path(sys.executable) != PYTHON:
            os.execv(PYTHON, [str(PYTHON), str(script), *sys.argv[1:]])
        sys.pycache_prefix = str(ROOT / "build" / "python")
        sys.dont_write_bytecode = False
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # end quietly where `| head` has read enough
    try:
        main = import_module(f"thercon.post.{module}").main
    except ModuleNotFoundError as missing:
        print(
            f"{script.name}: error: the Python package '{missing.name}' is missing; install the "
            f"packages of {ROOT / 'post' / 'requirements.txt'}, on Debian by apt-get install python3-h5py "
            "python3-matplotlib, in the source tree by ./setup.sh build",
            file=sys.stderr,
        )
        return FAILED
    return main()
