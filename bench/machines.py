"""Jobs on other machines, or in other processes here: a Dask cluster in place of this process's threads.

The machines share the project's folder, at the same path, and a program that is built there. What is timed stays here.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from bench.programs import MeasureError

SILENT = 60  # above all levels of logging


@contextmanager
def machines(scheduler: str | None) -> Iterator[Executor | None]:
    """Where jobs run that share the processors: `tcp://HOST:PORT` is a scheduler's address, `local:N` N processes here.
    None: nowhere else."""
    if scheduler is None:
        yield None
        return
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise MeasureError("--scheduler: Dask is missing: pip install 'dask[distributed]'") from error
    kind, _, count = scheduler.partition(":")
    try:
        local = None if kind != "local" else LocalCluster(
            n_workers=int(count), threads_per_worker=1, dashboard_address=":0", silence_logs=SILENT
        )
        client = Client(local or scheduler, set_as_default=False, timeout="20s")
    except (OSError, ValueError) as error:
        raise MeasureError(f"--scheduler {scheduler}: expected tcp://HOST:PORT of a Dask scheduler, or local:N: "
                           f"{error}") from error
    try:
        executor: Executor = client.get_executor(pure=False)
        yield executor
        executor.shutdown(wait=False)
    finally:
        client.close()
        if local:
            local.close()
