"""What a long check found, kept in out/verify/ for the table of docs/reliability.md.

A check is a module of this folder, `scripts/venv python -m tests.verify.NAME`. It ends by `record`, and with
exit status 1 where something failed.
"""

from __future__ import annotations

import datetime
import json
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
KEPT = TOP / "out" / "verify"


def commit() -> str:
    """The tree's commit, with a + where files differ from it; "unknown" outside a repository."""
    found = subprocess.run(["git", "describe", "--always", "--dirty=+"], cwd=TOP, capture_output=True, text=True)
    return found.stdout.strip() or "unknown"


def told(figures: Mapping[str, int | float]) -> str:
    """As the table shows them: "3000 scenes, 12 refused"."""
    return ", ".join(f"{value} {label}" for label, value in figures.items())


def record(name: str, figures: Mapping[str, int | float], failures: int, arguments: Sequence[str] | None = None) -> int:
    """Keep what the check `name` found. Returns the exit status.

    figures: a label, and the number that stands before it in the table. arguments: those that would ask for this alone,
    where the command line asked for more.
    """
    KEPT.mkdir(parents=True, exist_ok=True)
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    module = f"tests.verify.{name.partition('-')[0]}"
    command = shlex.join(["scripts/venv", "python", "-m", module, *(sys.argv[1:] if arguments is None else arguments)])
    found = {"name": name, "command": command, "date": today, "commit": commit(),
             "figures": dict(figures), "failures": failures}
    (KEPT / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(f"{name}: {told(figures)}; {failures or 'none'} failed")
    return 1 if failures else 0


def logged(command: Sequence[str], log: Path, env: Mapping[str, str] | None = None,
           timeout: float | None = None, top: Path = TOP) -> int:
    """Run a command at the top of a tree, with all that it prints in a file. Its exit status.

    Raises subprocess.TimeoutExpired after `timeout` seconds; what was printed until then is kept.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("w", encoding="utf-8") as file:
        return subprocess.run(command, cwd=top, env=env, timeout=timeout, stdout=file,
                              stderr=subprocess.STDOUT).returncode


def kept() -> list[dict]:
    """What is recorded, by name."""
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(KEPT.glob("*.json"))]
