"""The one place that makes HTML: whatever is put into a form is escaped, unless it is HTML itself."""

import base64
import gzip
import hashlib
import json
from html import escape
from pathlib import Path
from string import Formatter

from ..words import printable

HERE = Path(__file__).parent


class Html(str):
    """Text that is HTML. Only this module makes it; put together with other text it is text."""


class Escaping(Formatter):
    """str.format for HTML."""

    def format_field(self, value, spec):
        """Return a value as HTML."""
        return value if isinstance(value, Html) else escape(printable(format(value, spec)))


def html(form, /, *values, **named):
    """Return the HTML `form`, which is part of the program, with values in its braces."""
    return Html(Escaping().vformat(form, values, named))


def joined(parts, separator=""):
    """Return parts, each as `html` puts it, one behind the other."""
    return Html(separator.join(html("{}", part) for part in parts))


def own(*names):
    """Return files that stand beside this one, one behind the other: styles or scripts."""
    return Html("\n" + "".join((HERE / name).read_text(encoding="utf-8") for name in names))


def digest(script):
    """Return what a policy names to allow a script: the hash of all between its tags."""
    return "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def compressed(data):
    """Return data as compressed JSON, in base64."""
    words = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return Html(base64.b64encode(gzip.compress(words.encode(), mtime=0)).decode())
