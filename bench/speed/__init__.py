"""What kage demands of its speed: each bound with its figures, in one run, beside the peers. `make speed` runs it.

    scripts/venv python -m bench.speed            from the project's top

    plan.py        how much is measured at which level, and the bounds
    launch.py      a small program that runs a command and prints its time, memory and bytes
    inputs.py      maps, meshes and scenes, made once and kept in the output's folder
    parts.py       the jobs of each part: kage and its peers
    rounds.py      runs all jobs round by round, so that whatever else the machine does slows all alike
    verdicts.py    each bound's figure with its interval, and whether it is met
    stages.py      instructions, cache misses and time of each stage
    pages.py       the report's tables, as Markdown, HTML and text
"""
