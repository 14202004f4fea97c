"""The bench: what each method costs, what it buys, and when to use which.

    scripts/venv python -m bench            from the project's top; `make bench` does that

    plan.py                 what is measured at which level
    runner.py, store.py     doing it; results as they come, so that an interrupted bench goes on where it was
    quality.py, cost.py, sweep.py     the jobs
    programs.py             running kage, POV-Ray, valgrind and the yardsticks, and reading what they print
    stats.py, masks.py, images.py     intervals, shadows against shadows, pictures against pictures
    summary.py, claims.py   the report's data, and what they say of the paper's claims
    report.py, plots.py, templates/   the report's pages
"""
