"""A process that renders for the tests with the Python package of one build. It is told what to do in lines of JSON.

Each line of stdin is a request: {"folder", "text", "options"}, where `text` is a scene. Each answer is a line of JSON,
and, where that says so, the planes of the picture, as they lie in memory. What the library prints would be seen as a
broken answer, so it is also a check that it prints nothing.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import kage


def rendered(request: dict[str, Any]) -> tuple[dict[str, Any], list[bytes]]:
    """The answer, and the planes."""
    scene = kage.load(request["text"], folder=request["folder"], name=request.get("name"), sets=request.get("first"),
                      threads=1, progress=False)
    if "then" in request:
        scene.render(**request["options"], progress=False)  # with all that a render builds
        scene.set(request["then"])
    if "file" in request:
        scene.render_file(request["file"], **request["options"], progress=False)
        return {"planes": []}, []
    picture = scene.render(**request["options"], progress=False)
    if "save" in request:
        picture.save(request["save"], threads=1, progress=False)
    planes = {name: picture[name] for name in picture.planes}
    return ({"planes": list(planes), "shape": [picture.height, picture.width]},
            [plane.astype("<f4").tobytes() for plane in planes.values()])


def main() -> None:
    for line in sys.stdin:
        try:
            answer, planes = rendered(json.loads(line))
        except kage.KageError as wrong:
            answer, planes = {"error": str(wrong)}, []
        sys.stdout.buffer.write((json.dumps(answer) + "\n").encode())
        for plane in planes:
            sys.stdout.buffer.write(plane)
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main()
