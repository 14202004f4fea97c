"""Many pictures on many processors or machines, by dask.distributed.

    python -m kage.sweep SCENE --vary objects.ground.bump.scale=0.05:0.5:10 --vary render.shadow=none,0,1,2 --out DIR

From Python:

    from kage.sweep import Output, Plan, axis, run

    plan = Plan.of("scene.yaml", [axis("render.shadow=none,0,1,2")], Output("DIR"))
    done = run(plan)

docs/sweep.md is the guide.
"""

from __future__ import annotations

try:
    from kage.sweep.axes import Axis, axis
    from kage.sweep.errors import SweepError
    from kage.sweep.keys import Keys
    from kage.sweep.plan import Output, Plan
    from kage.sweep.run import Done, run
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(f"kage.sweep needs {missing.name}: pip install 'dask[distributed]' Jinja2") from missing

__all__ = ["Axis", "Done", "Keys", "Output", "Plan", "SweepError", "axis", "run"]
