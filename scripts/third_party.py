"""The Python packages of requirements.txt with their licences, for docs/third-party.md.

    scripts/venv python -m scripts.third_party           the table
    scripts/venv python -m scripts.third_party --write   into docs/third-party.md

The licences are what the installed packages state of themselves.
"""

from __future__ import annotations

import argparse
import re
from importlib import metadata
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
LIST = TOP / "docs" / "third-party.md"
BEGIN, END = "<!-- python -->\n", "<!-- /python -->\n"

#: Of packages whose metadata do not name one; their files do.
UNSTATED = {"OpenEXR": "BSD-3-Clause", "matplotlib": "matplotlib's licence, based on PSF-2.0"}


def required() -> list[str]:
    """The names in requirements.txt, in its order."""
    return re.findall(r"^([\w.-]+)==", (TOP / "requirements.txt").read_text(encoding="utf-8"), re.MULTILINE)


def license_of(name: str) -> str:
    """An SPDX expression where the package has one, else what it calls its licence."""
    told = metadata.metadata(name)
    short = str(told.json.get("license", ""))
    classified = [line.split(" :: ")[-1] for line in told.get_all("Classifier") or [] if line.startswith("License")]
    named = str(told.json.get("license_expression", "")) or UNSTATED.get(name, "")
    named = named or (short if 0 < len(short) < 40 and short != "UNKNOWN" and "\n" not in short else "")
    if not named and not classified:
        raise ValueError(f"{name} states no licence: look for it in its files, and add it to UNSTATED")
    return named or " or ".join(classified)


def table() -> str:
    rows = "".join(f"| {name} | {license_of(name)} |\n" for name in sorted(required(), key=str.lower))
    return f"| package | licence |\n|---|---|\n{rows}"


def written(text: str) -> str:
    """The document with a fresh table."""
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{table()}\n{END}{after}"


def main() -> None:
    parser = argparse.ArgumentParser(description="List the licences of the Python packages.")
    parser.add_argument("--write", action="store_true", help="write the table into docs/third-party.md")
    if parser.parse_args().write:
        LIST.write_text(written(LIST.read_text(encoding="utf-8")), encoding="utf-8")
    else:
        print(table(), end="")


if __name__ == "__main__":
    main()
