"""The table of docs/reliability.md: python -m tests.verify.table [--write].

A row is what a check has recorded here; of one that has not run here it stays as it is.
"""

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


def table(records: list[dict], page: str) -> str:
    lines = "".join(MARKED.findall(page)).split("\n")[1:-2]  # the table without the empty lines around it
    rows = {line.split()[1]: line for line in lines[2:]} | {found["name"]: row(found) for found in records}
    return "\n".join(["", *lines[:2], *(rows[name] for name in sorted(rows))]) + "\n\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="into docs/reliability.md")
    options = parser.parse_args()
    records = record.kept()
    if not records:
        sys.exit("out/verify/ has no records: run make verify")
    page = PAGE.read_text(encoding="utf-8")
    written = table(records, page)
    print(written, end="")
    if options.write:
        PAGE.write_text(MARKED.sub(lambda _: written, page), encoding="utf-8")
    return 1 if any(found["failures"] for found in records) else 0


if __name__ == "__main__":
    sys.exit(main())
