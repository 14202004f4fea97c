"""What the worker processes of a cluster on this machine begin with.

Ctrl-C in a terminal goes to all its processes, but it is for the one that started the others, which then ends them.
"""

from __future__ import annotations

import signal


def dask_setup(_worker: object) -> None:
    """Called by Dask in a new worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
