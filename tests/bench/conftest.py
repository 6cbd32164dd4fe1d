"""Makes the modules of the other tests known to the themes."""

import report  # noqa: F401
