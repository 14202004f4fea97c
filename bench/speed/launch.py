"""Runs a command a number of times and prints, as JSON, its seconds, its highest memory and the bytes of its files.

    python -I -S launch.py TIMES COMMAND...

It is small and imports little: a process starts with the peak memory of the process that starts it.
"""

import os
import sys
import time


def bytes_of(pid: int) -> dict[str, int]:
    """Read and written, of a process that has ended and was not waited for; none where the system has no count."""
    try:
        with open(f"/proc/{pid}/io") as file:  # noqa: PTH123 - pathlib takes memory
            lines = dict(line.split(":") for line in file)
        return {"read": int(lines["rchar"]), "written": int(lines["wchar"])}
    except (OSError, ValueError, KeyError):
        return {}


def once(command: list[str], output: int) -> dict[str, object]:
    begin = time.perf_counter()
    pid = os.posix_spawnp(command[0], command, os.environ,
                          file_actions=[(os.POSIX_SPAWN_DUP2, output, 1), (os.POSIX_SPAWN_DUP2, output, 2)])
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    seconds = time.perf_counter() - begin
    moved = bytes_of(pid)
    _, status, usage = os.wait4(pid, 0)
    unit = 1 if sys.platform == "darwin" else 1024
    return {"seconds": seconds, "cpu": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss * unit,
            "status": os.waitstatus_to_exitcode(status), **moved}


if __name__ == "__main__":
    runs = [once(sys.argv[2:], 2) for _ in range(int(sys.argv[1]))]
    print(str(runs).replace("'", '"'))
