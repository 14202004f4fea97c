"""How a sweep's tasks spread over workers: what a task costs besides its work, and what many workers would do.

    python -m bench.scaling --out DIR   # DIR/scaling.json and scaling.svg, and the tables of docs/sweep.md

Tasks that sleep stand for renders, so that the workers need no more processors than there are here: what is left is
what Dask costs. The processor time of scheduler and client for empty tasks tells how many a second they can do at most,
also on a busy machine; from it follows how long a task must be to keep any number of workers busy.
"""

from __future__ import annotations

import argparse
import functools
import json
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from distributed import Client, LocalCluster, as_completed

SILENT = 60  # above all levels of logging
SECONDS = (0.1, 1.0, 5.0)  # of a task
WORKERS = (1, 2, 4)
FARMS = (10, 100, 1000)
EMPTY = 1000  # tasks
ROUNDS = 3


def timed(client: Client, seconds: float, count: int) -> float:
    """Send tasks as kage.sweep does, and wait for all."""
    start = time.monotonic()
    futures = [client.submit(work, seconds, number, key=f"task-{start}-{number}", priority=-number)
               for number in range(count)]
    for _ in as_completed(futures, loop=client.loop):
        pass
    return time.monotonic() - start


def work(seconds: float, number: int) -> int:
    time.sleep(seconds)
    return number


def with_workers(count: int, measure: Callable[[Client], Any]) -> Any:
    with LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=":0", silence_logs=SILENT) as cluster, \
            Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=120)
        timed(client, 0, 50)
        return measure(client)


def measured() -> dict[str, Any]:
    """For each number of workers and length of task the share of time in tasks; and the rate of empty tasks."""
    rows: list[dict[str, float]] = []
    for count in WORKERS:
        shares = with_workers(count, functools.partial(all_shares, count))
        rows += [{"workers": count, "seconds": s, "busy": part} for s, part in zip(SECONDS, shares, strict=True)]
    return {"rows": rows, "rate": with_workers(2, empty_rate), "own": own_cost(rows)}


def all_shares(workers: int, client: Client) -> list[float]:
    return [share(client, workers, seconds) for seconds in SECONDS]


def share(client: Client, workers: int, seconds: float) -> float:
    each = max(2, min(40, round(6 / seconds)))
    return each * seconds / timed(client, seconds, each * workers)


def empty_rate(client: Client) -> float:
    """Tasks a second of processor time, of scheduler and client, which are this process."""
    rates = []
    for _ in range(ROUNDS):
        start = time.process_time()
        timed(client, 0, EMPTY)
        rates.append(EMPTY / (time.process_time() - start))
    return statistics.median(rates)


def own_cost(rows: list[dict[str, float]]) -> float:
    """Seconds that a worker loses for each task: from the shortest tasks on one worker."""
    first = rows[0]
    return first["seconds"] * (1 / first["busy"] - 1)


def busy(workers: int, seconds: float, rate: float, own: float) -> float:
    """The share of their time that workers render: each loses `own` for a task; the scheduler starts `rate` tasks a
    second at most."""
    return min(seconds / (seconds + own), rate * seconds / workers)


def least(workers: int, rate: float) -> float:
    """The length of task at which the scheduler just keeps up."""
    return workers / rate


# What is shown --------------------------------------------------------------------------------------


def tables(found: dict[str, Any]) -> str:
    """In Markdown."""
    head = ["task", *(f"{count} worker{'s' * (count > 1)}" for count in WORKERS)]
    lines = [head, ["---"] * len(head)]
    for seconds in SECONDS:
        shares = [row["busy"] for row in found["rows"] if row["seconds"] == seconds]
        lines.append([f"{seconds:g} s", *(f"{100 * share:.1f} %" for share in shares)])
    rate, own = found["rate"], found["own"]
    model = [["workers", "shortest task", *(f"tasks of {s:g} s" for s in SECONDS)], ["---"] * (2 + len(SECONDS))]
    for count in FARMS:
        model.append([str(count), f"{least(count, rate):.2f} s",
                      *(f"{100 * busy(count, s, rate, own):.0f} %" for s in SECONDS)])
    text = "\n\n".join("\n".join(f"| {' | '.join(line)} |" for line in part) for part in (lines, model))
    return f"{text}\n\nempty tasks: {rate:.0f} a second; a worker loses {1000 * own:.1f} ms for a task\n"


def plot(found: dict[str, Any], path: Path) -> None:
    """The busy share over the length of a task, for some numbers of workers."""
    import matplotlib as mpl
    import numpy as np

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "kage"
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 3.8), layout="constrained")
    lengths = np.geomspace(0.01, 100, 300)
    for count in (1, *FARMS):
        shares = [100 * busy(count, s, found["rate"], found["own"]) for s in lengths]
        axes.plot(lengths, shares, label=f"{count} worker{'s' * (count > 1)}, model")
    for count, marker in zip(WORKERS, "osD", strict=True):
        rows = [row for row in found["rows"] if row["workers"] == count]
        axes.plot([row["seconds"] for row in rows], [100 * row["busy"] for row in rows], f"k{marker}", markersize=4,
                  fillstyle="none", label=f"{count} worker{'s' * (count > 1)}, measured")
    axes.set(xscale="log", xlabel="length of a task, seconds", ylabel="time spent in tasks, %", ylim=(0, 103))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, frameon=False)
    figure.savefig(path, metadata={"Date": None})


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m bench.scaling", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    found = measured()
    (options.out / "scaling.json").write_text(json.dumps(found, indent=1) + "\n")
    plot(found, options.out / "scaling.svg")
    print(tables(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
