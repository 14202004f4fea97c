"""What a long check found, kept in out/verify/ for the table of docs/reliability.md.

A check is a module of this folder, `scripts/venv python -m tests.verify.NAME`. It ends by `record`, and with
exit status 1 where something failed.
"""

from __future__ import annotations

import datetime
import json
import subprocess
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
KEPT = TOP / "out" / "verify"


def commit() -> str:
    """The tree's commit, with a + where files differ from it; "unknown" outside a repository."""
    found = subprocess.run(["git", "describe", "--always", "--dirty=+"], cwd=TOP, capture_output=True, text=True)
    return found.stdout.strip() or "unknown"


def record(name: str, command: str, figures: dict[str, int | float | str], failures: int) -> int:
    """Keep what the check `name` found. Returns the exit status.

    command: what a person types to repeat it. figures: a label, as the table shows it, and its value.
    """
    KEPT.mkdir(parents=True, exist_ok=True)
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    told = {"name": name, "command": command, "date": today, "commit": commit(),
            "figures": figures, "failures": failures}
    (KEPT / f"{name}.json").write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    print(f"{name}: " + ", ".join(f"{label} {value}" for label, value in figures.items()) + f"; {failures} failed")
    return 1 if failures else 0


def kept() -> list[dict]:
    """What is recorded, by name."""
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted(KEPT.glob("*.json"))]
