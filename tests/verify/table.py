"""The table of docs/reliability.md, from what the long checks have recorded: python -m tests.verify.table [--write]."""

from __future__ import annotations

import argparse
import re
import sys

from tests.verify import record

PAGE = record.TOP / "docs" / "reliability.md"
MARKED = re.compile(r"(?<=<!-- verify -->\n).*?(?=<!-- /verify -->)", re.DOTALL)


def row(found: dict) -> str:
    return (f"| {found['name']} | {record.told(found['figures'])} | {found['failures'] or 'none'} | "
            f"`{found['command']}` | {found['date']} | {found['commit']} |")


def table(records: list[dict]) -> str:
    head = ["", "| check | what was tried | failed | command | date | commit |", "|---|---|---|---|---|---|"]
    return "\n".join([*head, *map(row, records)]) + "\n\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="into docs/reliability.md")
    options = parser.parse_args()
    records = record.kept()
    if not records:
        sys.exit("out/verify/ has no records: run make verify")
    print(table(records), end="")
    if options.write:
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(MARKED.sub(lambda _: table(records), page), encoding="utf-8")
    return 1 if any(found["failures"] for found in records) else 0


if __name__ == "__main__":
    sys.exit(main())
