"""The bench: what each method costs, what it buys, and when to use which.

    scripts/venv python -m bench            from the project's top, as `make bench` does

    plan.py                 what is measured at which level
    runner.py, store.py     run the jobs, and keep results as they come, so that an interrupted bench can go on
    quality.py, whole.py, cost.py, sweep.py     the jobs
    speed/                  by itself: the bounds of docs/performance.md (`make speed`)
    callgrind.py            instructions and cache misses of each function
    programs.py             runs kage, POV-Ray, valgrind and the yardsticks, and reads their output
    stats.py, masks.py, images.py     intervals, shadows against shadows, pictures against pictures
    data.py                 the types of a report's data
    summary.py              makes these data
    claims.py, bounds.py    judge the paper's claims by them, kage's, and what kage demands of itself
    tables.py, plots.py, page.py, report.py, templates/     the report's files
    readme.py               the tables of README.md and docs/
    widths.py               by itself: derivatives over a width as large as the shift, for docs/method.md
"""
