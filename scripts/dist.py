"""Make the source archive, out/kage-VERSION.tar.gz: the same bytes from the same commit.

    scripts/venv python -m scripts.dist [-o FOLDER]     (make dist)

In a repository it holds the files of HEAD, dated by that commit; what is not committed is not in it. In an unpacked
archive it holds that tree, dated as it is, and so is the archive again. SOURCE_DATE_EPOCH sets another date. Names
are sorted, owners are root, and modes are 644 or 755. It needs no package of requirements.txt.
"""

from __future__ import annotations

import argparse
import gzip
import io
import os
import re
import stat
import sys
import tarfile
from pathlib import Path

from scripts import tree

TOP = tree.TOP
DATED = "LICENSE"  # in an unpacked archive: the file whose date is that of all


def version(top: Path = TOP) -> str:
    """KAGE_VERSION, which all else takes from kage.h."""
    found = re.search(r'define KAGE_VERSION "([^"]+)"', (top / "include" / "kage.h").read_text(encoding="utf-8"))
    if not found:
        sys.exit("dist: include/kage.h defines no KAGE_VERSION")
    return found[1]


def date(top: Path) -> int:
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given is not None:
        return int(given)
    if tree.is_repository(top):
        return int(tree.git("log", "-1", "--format=%ct", top=top))
    return int((top / DATED).stat().st_mtime)


def committed(top: Path) -> dict[str, tuple[bytes, bool]]:
    """The files of HEAD by name: the bytes, and whether it is a program."""
    with tarfile.open(fileobj=io.BytesIO(tree.git("archive", "HEAD", top=top))) as archive:
        return {member.name: (opened.read(), bool(member.mode & stat.S_IXUSR))
                for member in archive if (opened := archive.extractfile(member))}


def unpacked(top: Path) -> dict[str, tuple[bytes, bool]]:
    return {name: ((top / name).read_bytes(), os.access(top / name, os.X_OK)) for name in tree.names(top)}


def packed(files: dict[str, tuple[bytes, bool]], folder: str, seconds: int) -> bytes:
    """The archive of some files in a folder."""
    raw = io.BytesIO()
    with tarfile.open(fileobj=raw, mode="w", format=tarfile.GNU_FORMAT) as archive:
        for name, (data, program) in sorted(files.items()):
            member = tarfile.TarInfo(f"{folder}/{name}")
            member.size, member.mtime, member.mode = len(data), seconds, 0o755 if program else 0o644
            member.uname = member.gname = "root"
            archive.addfile(member, io.BytesIO(data))
    return gzip.compress(raw.getvalue(), mtime=0)


def make(top: Path, to: Path) -> Path:
    name = f"kage-{version(top)}"
    files = committed(top) if tree.is_repository(top) else unpacked(top)
    to.mkdir(parents=True, exist_ok=True)
    archive = to / f"{name}.tar.gz"
    new = archive.with_name(archive.name + ".part")
    new.write_bytes(packed(files, name, date(top)))
    new.replace(archive)
    return archive


def main() -> None:
    parser = argparse.ArgumentParser(description="Make the source archive.")
    parser.add_argument("-o", "--output", type=Path, default=TOP / "out", help="default: out")
    made = make(TOP, parser.parse_args().output)
    print(f"{made}: {made.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
