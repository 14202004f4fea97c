"""bench/report.py: the made-up report of bench_sample.py, written, read again, and looked at in a browser."""

from __future__ import annotations

import csv
import re
import sys
from copy import deepcopy
from pathlib import Path

import pytest

from bench import plots, report, tables
from tests.support import bench_sample, browser

FILES = {"index.html", "report.md", "cost.csv", "quality.csv", "sweeps.csv", "slopes.csv",
         "whole.csv", "series.csv", "own.csv"}
NO_PICTURES = {"size": [640, 480], "scenes": {}}


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict, Path]:
    """The report, and the folder of its pictures. Tests that change the report take a copy."""
    folder = tmp_path_factory.mktemp("bench")
    return bench_sample.make_report(folder), folder


@pytest.fixture(scope="module")
def written(sample: tuple[dict, Path]) -> Path:
    data, folder = sample
    assert report.write(data, folder) == []
    return folder


def small(sample: tuple[dict, Path]) -> dict:
    """A copy with one scene and no pictures, which is soon drawn."""
    data = deepcopy(sample[0]) | {"sweeps": [], "slopes": {}, "pictures": deepcopy(NO_PICTURES)}
    return data | {"scenes": {"cube": data["scenes"]["cube"]}}


def read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def only(rows: list[dict[str, str]], **wanted: str) -> dict[str, str]:
    (found,) = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    return found


# CSV and Markdown -----------------------------------------------------------------------------------------------


def test_all_files(written: Path) -> None:
    assert {path.name for path in written.iterdir()} == FILES | {"pictures"}


def test_cost_csv(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    rows = read_csv(written / "cost.csv")
    timed = set(data["methods"]) | set(data["variants"])
    assert len(rows) == len(data["scenes"]) * len(timed) + len(data["cost"]["peers"])
    entry = data["cost"]["scenes"]["sphere"]["methods"]["march:4"]
    row = only(rows, scene="sphere", method="march:4")
    assert float(row["ns_median"]) == entry["ns"]["median"]
    assert float(row["added_low"]) == entry["added"]["low"]
    assert float(row["stages_shift"]) == entry["stages"]["shift"]
    assert row["command"] == entry["command"]
    assert only(rows, scene="cube", method="none")["added_median"] == ""
    assert float(only(rows, program="POV-Ray, bump_map")["ns_median"]) == 1449.0


def test_quality_csv(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    rows = read_csv(written / "quality.csv")
    assert len(rows) == len(data["scenes"]) * len(data["methods"])
    row = only(rows, scene="terrain", method="1 bare")
    entry = data["quality"]["scenes"]["terrain"]["1 bare"]
    assert float(row["mask_wrong"]) == 18.64
    assert float(row["hybrid_psnr"]) == entry["hybrid"]["psnr"]
    assert only(rows, scene="terrain", method="displaced")["tau_median"] == ""


def test_whole_csv(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    row = only(read_csv(written / "whole.csv"), scene="waves", variant="relief")
    entry = data["whole"]["scenes"]["waves"]["relief"]
    assert (float(row["off_8"]), float(row["povray_off_8"])) == (entry["off_8"], entry["povray"]["off_8"])
    row = only(read_csv(written / "series.csv"), scene="cube", over="light", value="20", variant="0")
    assert float(row["off"]) == data["whole"]["lamps"]["cube"]["off"]["0"][1]
    row = only(read_csv(written / "own.csv"), scene="cube", light="10", how="own 8")
    assert (row["shadow_pixels"], float(row["wrong"])) == ("60000", 3.1)


def test_whole_pictures_in_words(sample: tuple[dict, Path], written: Path) -> None:
    """In tables: what is off, what it costs, which no other beats, and what was not measured."""
    text = (written / "report.md").read_text(encoding="utf-8")
    part = text.split("## The whole picture")[1]
    (line,) = re.findall(r"^\| relief \| (.*) \|$", part.split("###")[0], re.MULTILINE)
    assert line.split(" | ")[:2] == ["0.02 ◆", "4.10 (4.08 to 4.13)"]
    (line,) = re.findall(r"^\| cube, 30° \| (.*) \|$", part, re.MULTILINE)
    assert line == "– | – | – | –"
    (line,) = re.findall(r"^\| auto \| (.*) \|$", part.split("What auto costs")[1].split("###")[1], re.MULTILINE)
    assert line.split(" | ")[1] == "0.0404 ★◆"
    assert "2.70 % of the receiver is at the silhouette" in part


@pytest.mark.parametrize("method, name", [("none", "bump only"), ("0", "order 0"), ("1 bare", "order 1, bare"),
                                          ("0 shifted, own 8", "order 0 shifted, own 8"), ("relief", "relief")])
def test_methods_by_name(method: str, name: str) -> None:
    assert tables.method_name(method) == name


def test_sweeps_csv(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    rows = read_csv(written / "sweeps.csv")
    sweep = data["sweeps"][1]
    assert len(rows) == sum(len(s["by_cost"]) * len(s["x"]["values"]) * len(s["y"]["values"]) for s in data["sweeps"])
    row = only(rows, sweep="slope-light", x="0.3", y="30", method="2+")
    assert float(row["wrong"]) == sweep["wrong"][3][3]["2+"]
    assert only(rows, sweep="slope-light", x="1.2", y="10", method="0")["wrong"] == ""


def test_slopes_csv(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    row = only(read_csv(written / "slopes.csv"), scene="waves", method="2", amplitude="0.08")
    assert float(row["error"]) == data["slopes"]["waves"]["error"]["2"][2]
    assert (float(row["fit"]), float(row["theory"])) == (3.01, 3)


def test_markdown(sample: tuple[dict, Path], written: Path) -> None:
    data, _ = sample
    text = (written / "report.md").read_text(encoding="utf-8")
    assert all(line in text for line in data["answer"])
    (line,) = re.findall(r"^\| march:8 \| (.*) \|$", text.split("## All methods")[1].split("##")[0], re.MULTILINE)
    cells = line.split(" | ")
    assert cells[0] == "0.03 ★◆"
    assert cells[1] == "+210 (+209 to +210)"
    assert cells[6] == "&lt;0.01 ★◆"
    assert "Incomplete" not in text
    for claim in data["claims"]:
        assert f"**{claim['verdict']}**: {claim['sentence']}" in text


def test_tables_have_as_many_cells_as_columns(written: Path) -> None:
    blocks = re.findall(r"(?:^\|.*\n)+", (written / "report.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(blocks) > 10
    for block in blocks:
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in block.splitlines()}) == 1


# What is computed -----------------------------------------------------------------------------------------------


def test_cheapest() -> None:
    wrong = {"none": 6.0, "0": 1.0, "1": None, "2": 0.3}
    order = ("none", "0", "1", "2")
    assert tables.cheapest(wrong, order, 1.0) == "0"
    assert tables.cheapest(wrong, order, 0.5) == "2"
    assert tables.cheapest(wrong, order, 0.1) is None
    assert tables.cheapest(None, order, 1.0) is None


def small_sweep(*cells: dict | None) -> dict:
    return {"x": {"values": [0.1 * (i + 1) for i in range(len(cells))], "label": "slope"}, "wrong": [list(cells)],
            "by_cost": ["none", "0", "2"]}


def test_reach_stops_at_the_first_that_is_too_wrong() -> None:
    sweep = small_sweep({"0": 0.2}, None, {"0": 1.0}, {"0": 3.0}, {"0": 0.5})
    assert tables.reach(sweep, 0, "0", 1.0) == pytest.approx(0.3)
    assert tables.reach(sweep, 0, "none", 1.0) is None


@pytest.mark.parametrize(("cells", "expected"), [
    (({"none": 0.5, "0": 0.1, "2": 0.0}, {"none": 2.0, "0": 0.9, "2": 0.9}),
     "bump only to 0.1, order 0 to the end (0.2)"),
    (({"none": 0.5, "0": 0.1, "2": 0.0}, {"none": 2.0, "0": 2.0, "2": 1.1}), "bump only to 0.1; beyond, none of these"),
    (({"none": 5.0, "0": 4.0, "2": 3.0}, {"none": 2.0, "0": 2.0, "2": 1.1}), "none of these is good enough"),
    ((None, None), "nothing measured"),
])
def test_rule_of_thumb(cells: tuple, expected: str) -> None:
    assert tables.rule_of_thumb(small_sweep(*cells), 0) == expected


def test_without_povray_the_truth_is_exact(sample: tuple[dict, Path]) -> None:
    data = deepcopy(sample[0])
    for entry in data["quality"]["scenes"]["cube"].values():
        entry["mask"] = None
    assert tables.truth_name(data, "cube") == "kage's exact"
    assert tables.wrong_pixels(data, "cube", "0") == data["quality"]["scenes"]["cube"]["0"]["exact"]["wrong"]


@pytest.mark.parametrize(("value", "expected"), [
    (None, "–"), (0, "0"), (0.3, "0.3"), (31.65, "31.6"), (1449.0, "1449"),
    (5.2e-5, "5.2·10⁻⁵"), (-0.25, "−0.25"),
    (float("inf"), "∞")])
def test_short(value: float | None, expected: str) -> None:
    assert tables.short(value) == expected


# The page -------------------------------------------------------------------------------------------------------


def test_complete(written: Path) -> None:
    assert "Incomplete" not in (written / "index.html").read_text(encoding="utf-8")


def test_same_data_same_bytes(sample: tuple[dict, Path], written: Path) -> None:
    before = {name: (written / name).read_bytes() for name in FILES}
    report.write(sample[0], written)
    assert before == {name: (written / name).read_bytes() for name in FILES}


def test_incomplete_is_told(sample: tuple[dict, Path], tmp_path: Path) -> None:
    missing = "POV-Ray is missing: its times are left out"
    data = small(sample) | {"complete": False, "incomplete": [missing]}
    report.write(data, tmp_path)
    for name in ("index.html", "report.md"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert "Incomplete" in text
        assert missing in text


def test_almost_nothing_measured(sample: tuple[dict, Path], tmp_path: Path) -> None:
    """As after an interruption: all that can be None is, and what can be empty is."""
    data = deepcopy(sample[0])
    for scene in data["cost"]["scenes"].values():
        scene["methods"] = {method: dict.fromkeys(entry) for method, entry in scene["methods"].items()}
    for methods in data["quality"]["scenes"].values():
        methods.update({method: dict.fromkeys(entry) for method, entry in methods.items()})
    for scene in data["whole"]["scenes"].values():
        scene.update({variant: dict.fromkeys(entry) for variant, entry in scene.items()})
    data |= {"complete": False, "sweeps": [], "slopes": {}, "pictures": NO_PICTURES, "claims": [], "answer": []}
    data["quality"] |= {"truth": None, "parity": {}}
    data["cost"] |= {"peers": [], "noise": {}}
    data["circumstances"] = {"date": "2026-11-22"} | dict.fromkeys(set(data["circumstances"]) - {"date"})
    assert report.write(data, tmp_path) == []
    assert "Not everything was measured" in (tmp_path / "index.html").read_text(encoding="utf-8")
    for absent in ("quality", "cost", "whole"):
        data[absent] = {}
    assert report.write(data, tmp_path) == []


def test_html_is_escaped(sample: tuple[dict, Path], tmp_path: Path) -> None:
    evil = "<script>alert('a & b')</script>"
    data = deepcopy(sample[0]) | {"notes": [evil], "answer": [evil], "incomplete": [evil], "pictures": NO_PICTURES}
    data["scenes"]["cube"]["title"] = evil
    data["sweeps"][0]["title"] = data["sweeps"][0]["x"]["label"] = evil
    data["claims"][0]["sentence"] = data["claims"][0]["cases"][0]["detail"] = evil
    data["cost"]["peers"][0]["note"] = evil
    report.write(data, tmp_path)
    for name in ("index.html", "report.md"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert "<script>alert" not in text
        assert "&lt;script" in text


def test_missing_picture(sample: tuple[dict, Path], tmp_path: Path) -> None:
    """One file is missing, another is no picture: the rest stands."""
    data = small(sample)
    pictures = bench_sample.make_pictures(tmp_path)["scenes"]
    data["pictures"]["scenes"] = {"cube": pictures["cube"]}
    (tmp_path / "pictures/cube/none.png").unlink()
    (tmp_path / "pictures/cube/0.wrong.png").write_text("no picture")
    messages = report.write(data, tmp_path)
    assert [re.search(r"pictures/\S+png", message)[0] for message in messages] == [
        "pictures/cube/none.png", "pictures/cube/0.wrong.png"]
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert all(message.split(":")[0] in page for message in messages)
    assert 'data-name="order 0"' in page
    assert 'data-name="bump only"' not in page.split('id="sheets"')[1]


def hide(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    for name in [n for n in sys.modules if n == package or n.startswith(f"{package}.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)


def test_without_jinja(sample: tuple[dict, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hide(monkeypatch, "jinja2")
    (message,) = report.write(small(sample), tmp_path)
    assert message.startswith("Jinja2 is missing")
    assert {path.name for path in tmp_path.iterdir()} == FILES - {"index.html"}


@pytest.mark.parametrize(("package", "name", "absent", "present"), [
    ("matplotlib", "matplotlib", "<svg", "<img"), ("PIL", "Pillow", "<img", "<svg")])
def test_without(package: str, name: str, absent: str, present: str, sample: tuple[dict, Path], tmp_path: Path,
                 monkeypatch: pytest.MonkeyPatch) -> None:
    data, folder = small(sample), sample[1]
    data["pictures"]["scenes"] = {"cube": sample[0]["pictures"]["scenes"]["cube"]}
    (tmp_path / "pictures").symlink_to(folder / "pictures")
    if package == "PIL":
        plots.cost_error(data, "cube")  # matplotlib wants Pillow, too: so it is loaded
    hide(monkeypatch, package)
    (message,) = report.write(data, tmp_path)
    assert message.startswith(f"{name} is missing")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert message in page
    assert absent not in page
    assert present in page


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, OSError])
def test_interrupted(interruption: type[BaseException], sample: tuple[dict, Path], tmp_path: Path,
                     monkeypatch: pytest.MonkeyPatch) -> None:
    data = small(sample)
    report.write(data, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    write_text = Path.write_text

    def write_half(path: Path, text: str, **how: str) -> None:
        if "index" in path.name:
            write_text(path, text[:1000], **how)
            raise interruption
        write_text(path, text, **how)

    monkeypatch.setattr(Path, "write_text", write_half)
    with pytest.raises(interruption):
        report.write(data | {"answer": ["another"]}, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


# Plots ----------------------------------------------------------------------------------------------------------


def test_plots_follow_the_page(sample: tuple[dict, Path]) -> None:
    data, _ = sample
    drawn = plots.cost_error(data, "cube")
    assert "currentColor" in drawn
    assert plots.INK not in drawn
    assert "<style" not in drawn
    for method in data["methods"]:
        assert f">{tables.method_name(method)}</text>" in drawn
    assert len(re.findall(" id=", drawn)) == len(set(re.findall(r' id="([^"]+)"', drawn)))


def test_user_settings_of_matplotlib_do_not_matter(sample: tuple[dict, Path]) -> None:
    import matplotlib

    before = plots.stage_bars(sample[0], "cube")
    with matplotlib.rc_context({"font.size": 30, "axes.grid": False, "svg.fonttype": "path"}):
        assert plots.stage_bars(sample[0], "cube") == before
        assert matplotlib.rcParams["font.size"] == 30


def test_labels_keep_apart() -> None:
    at = [(100 + 3.0 * i, 100 + 2.0 * (i % 3)) for i in range(8)]
    frame = plots.Box(0, 0, 300, 250)
    placed = [spot.box for spot in plots.spread_labels(at, [(44, 11)] * len(at), frame, [])]
    assert all(a.overlap(b) == 0 for i, a in enumerate(placed) for b in placed[:i])
    assert all(box.outside(frame) == 0 for box in placed)
    assert all(box.overlap(plots.Box(x - 3, y - 3, x + 3, y + 3)) == 0 for box in placed for x, y in at)


def test_bars_do_not_strike_through_labels(sample: tuple[dict, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the intervals are as wide as on a busy machine."""
    data, placed = deepcopy(sample[0]), []
    for entry in data["cost"]["scenes"]["cube"]["methods"].values():
        if entry["added"]:
            entry["added"] |= {"low": 0.6 * entry["added"]["low"] - 3, "high": 1.5 * entry["added"]["high"] + 3}
    spread = plots.spread_labels

    def watched(at: list, sizes: list, frame: plots.Box, lines: list) -> list:
        found = spread(at, sizes, frame, lines)
        placed.append((found, [line for line in lines if line[1] == line[3]]))
        return found

    monkeypatch.setattr(plots, "spread_labels", watched)
    plots.cost_error(data, "cube")
    ((spots, bars),) = placed
    assert len(bars) >= len(data["methods"]) - 1
    assert sum(plots.crosses(spot.box, bar) for spot in spots for bar in bars) <= 1  # one may have no other place


@pytest.mark.parametrize(("line", "expected"), [
    ((0, 5, 20, 5), True), ((5, -5, 5, 30), True), ((4, 4, 6, 6), True), ((0, 20, 20, 20), False),
    ((-5, 0, 0, -5), False)])
def test_crosses(line: tuple, expected: bool) -> None:
    assert plots.crosses(plots.Box(0, 0, 10, 10), line) is expected


def test_sweep_map_names_and_hatches(sample: tuple[dict, Path]) -> None:
    sweep = sample[0]["sweeps"][0]
    drawn = plots.sweep_map(sweep, 1.0)
    cells = [cell for row in sweep["wrong"] for cell in row if cell is not None]
    for method in sweep["by_cost"][:3]:
        told = sum(tables.cheapest(cell, sweep["by_cost"], 1.0) == method for cell in cells)
        assert len(re.findall(f">{re.escape(plots.cell_name(method))}</text>", drawn)) == told
    assert "<pattern" in drawn


# In the browser -------------------------------------------------------------------------------------------------


def test_five_scenes_fit_a_desk(sample: tuple[dict, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The main table is seen whole, with intervals as wide as they get, and the slider before all else."""
    from bench import page

    data = deepcopy(sample[0]) | {"sweeps": [], "slopes": {}}
    for part in (data["scenes"], data["cost"]["scenes"], data["quality"]["scenes"], data["whole"]["scenes"]):
        part["torus"] = deepcopy(part["sphere"])
    for scene in data["cost"]["scenes"].values():
        for entry in scene["methods"].values():
            entry["added"] = entry["added"] and {"median": 408.2, "low": -258.4, "high": 681.3, "n": 7}
    monkeypatch.setattr(page, "make_plots", lambda _: page.Plots())
    text, _ = page.render(data, sample[1])
    (tmp_path / "index.html").write_text(text, encoding="utf-8")
    with browser.browser() as driver:
        browser.resize(driver, browser.DESKTOP)
        driver.get((tmp_path / "index.html").as_uri())
        for table in ("#main-table", "#whole table.main"):
            wide, frame = driver.execute_script(
                "const t = document.querySelector(arguments[0]).parentElement; return [t.scrollWidth, t.clientWidth];",
                table)
            assert wide <= frame, f"{table}: {wide} px in a frame of {frame}"
        assert driver.find_element("css selector", ".stage").rect["y"] < browser.DESKTOP[1] / 2


def test_none_is_no_word_of_the_page(written: Path) -> None:
    """The method has a name that cannot be taken for the English word, wherever a reader sees it."""
    page = (written / "index.html").read_text(encoding="utf-8")
    seen = re.sub(r"<(style|script).*?</\1>", "", page, flags=re.DOTALL)
    seen = re.sub(r"<(?:td class=\"words\"|code)>[^<]*</(?:td|code)>", "", seen)  # commands, as they are typed
    words = re.findall(r">[^<]*\b[Nn]one\b[^<]*<", seen)
    assert [word for word in words if "none of these" not in word] == []
    assert "bump only" in seen


def test_page_in_a_browser(written: Path) -> None:
    browser.check_page(written / "index.html")


@pytest.mark.parametrize(("fault", "told"), [
    ('<img alt="" src="https://example.invalid/a.png">', "a.png"), ('<p id="main-table">twice</p>', "main-table"),
    ("<script>fetch('https://example.invalid/b').catch(() => 0);</script>", "requests: .*invalid/b"),
    ("<script>console.error('broken');</script>", "broken"), ('<div style="width: 3000px">wide</div>', "too wide"),
    ("<style>.side.left, .line { --split: 50% !important; }</style>", "border at 50")])
def test_faults_are_found(fault: str, told: str, written: Path, tmp_path: Path) -> None:
    """Of the check itself: a page with one fault does not pass."""
    page = tmp_path / "index.html"
    page.write_text((written / "index.html").read_text(encoding="utf-8").replace("</main>", f"{fault}</main>"),
                    encoding="utf-8")
    with pytest.raises(AssertionError, match=told):
        browser.check_page(page)


def test_compare_button_and_size(written: Path) -> None:
    from selenium.webdriver.support.select import Select

    with browser.browser() as driver:
        browser.resize(driver, browser.DESKTOP)
        browser.open_page(driver, written / "index.html")
        find = driver.find_element
        button = find("css selector", "#sheets figure[data-scene=terrain][data-name='march:4'] button")
        driver.execute_script("arguments[0].click()", button)
        form = find("css selector", ".comparison")
        assert [Select(form.find_element("name", name)).first_selected_option.text for name in ("scene", "right")] == [
            "terrain", "march:4"]
        Select(form.find_element("name", "zoom")).select_by_value("4")
        left, stage, view = driver.execute_script(
            "const v = document.querySelector('.window');"
            "return [v.scrollLeft, document.querySelector('.stage').clientWidth, v.clientWidth];")
        assert stage == pytest.approx(4 * view, abs=2)
        assert left == pytest.approx((stage - view) / 2, abs=30)  # the middle stays; a scroll bar may come
        assert browser.sideways(driver) <= 0


def test_page_without_script(written: Path) -> None:
    with browser.browser(script=False) as driver:
        browser.resize(driver, browser.DESKTOP)
        driver.get((written / "index.html").as_uri())
        assert not driver.find_elements("css selector", ".has-script, .comparison")
        assert driver.find_element("css selector", "noscript p").size["height"] > 0
        assert driver.find_element("css selector", "#main-table").is_displayed()
        pictures = driver.find_elements("css selector", "#sheets img")
        assert len(pictures) == len(bench_sample.SCENES) * (2 * len(bench_sample.METHODS) + 2)
        assert not browser.bad_images(driver)
