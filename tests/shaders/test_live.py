"""docs/live/: the page is what its parts make, draws what kage draws, and can be used by mouse, finger and keys."""

from __future__ import annotations

import base64
import contextlib
import json
import re
import subprocess
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from scripts import live
from tests.conftest import PROGRAM, TOP
from tests.support import browser
from tests.support.browser import DESKTOP, PHONE

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

SIZE = (128, 96)
NEAR = 2         # codes of 255
SHARE = 0.99     # of the pixels that must be as near
HEAVY = 1.5e6    # bytes of the page
WAIT = 60        # seconds, for a processor that draws beside other tests
OPEN = "#line=1"  # nothing moves at the start
DESK = (320, 700)  # a small picture is soon drawn
COPIES = "GPU stall due to ReadPixels"  # how Chromium without a graphics card copies a canvas to the window

#: The page's method, changes of its state, and the options of kage that mean the same.
METHODS: dict[str, tuple[str, dict[str, Any], list[str]]] = {
    **{name: (name, {}, ["--shadow", name]) for name in ("none", "0", "1", "2", "2+")},
    "march:8": ("march", {"march": 8}, ["--shadow", "march:8"]),
    "shifted": ("2+", {"shade": True}, ["--shadow", "2+", "--shade", "shifted"]),
    "own": ("0", {"own": True, "steps": 24}, ["--shadow", "0", "--bump-shadow", "march:24"]),
    "all": ("march", {"march": 8, "shade": True, "own": True, "steps": 16},
            ["--shadow", "march:8", "--shade", "shifted", "--bump-shadow", "march:16"]),
    "displaced": ("displaced", {}, ["--surface", "displaced"]),
}
SCENES = ("cube", "sphere", "terrain")
#: Shaders take long to compile here; what `all` has together is tried apart on one scene.
APART = {"shifted": "sphere", "own": "cube"}


@pytest.fixture(scope="module")
def page() -> Iterator[Chrome]:
    with browser.browser(webgl=True) as driver:
        yield driver


@pytest.fixture
def driver(page: Chrome) -> Iterator[Chrome]:
    """The page anew, on a desk; whatever a test does, the console stays empty."""
    load(page)
    yield page
    assert messages(page) == []


def messages(driver: Chrome) -> list[str]:
    return [text for text in browser.errors(driver) if COPIES not in text]


def load(driver: Chrome, hash_: str = OPEN, size: tuple[int, int] = DESK, phone: bool = False) -> None:
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    browser.resize(driver, size, phone)
    driver.get("about:blank")
    driver.get(live.PAGE.as_uri() + hash_)
    settle(driver)


def wait(driver: Chrome, script: str, *arguments: object) -> Any:
    """Until the script returns what is true."""
    from selenium.webdriver.support.ui import WebDriverWait

    return WebDriverWait(driver, WAIT, 0.05).until(lambda d: d.execute_script(f"return {script}", *arguments), script)


def settle(driver: Chrome) -> None:
    """Until a frame has been drawn, in full, and nothing is left to draw."""
    wait(driver, "live.frame.count > 0 && !live.frame.busy && !live.frame.moves"
                 " && live.frame.width === document.getElementById('canvas').clientWidth;")


def state(driver: Chrome) -> dict[str, Any]:
    return driver.execute_script("return live.state;")


def pixels(driver: Chrome, changes: dict[str, Any], method: str, samples: int = 1) -> np.ndarray:
    """The page's picture, as its shaders have it."""
    text = driver.execute_script(
        "live.set(arguments[0]);"
        "return btoa(String.fromCharCode(...live.pixels(arguments[1], arguments[2], arguments[3], arguments[4])));",
        changes, *SIZE, method, samples)
    picture = np.frombuffer(base64.b64decode(text), dtype=np.uint8).reshape(SIZE[1], SIZE[0], 4)
    assert (picture[..., 3] == 255).all()
    return picture[::-1, :, :3].astype(int)


def kage(folder: Path, scene: str, *options: str, size: tuple[int, int] = SIZE) -> np.ndarray:
    png = folder / "kage.png"
    subprocess.run([PROGRAM, "render", TOP / "scenes" / f"{scene}.yaml", "--size", f"{size[0]}x{size[1]}", *options,
                    "-o", png, "--quiet"], check=True)
    with Image.open(png) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def share_near(a: np.ndarray, b: np.ndarray) -> float:
    return float((np.abs(a - b).max(axis=2) <= NEAR).mean())


# The file -------------------------------------------------------------------------------------------------------


def test_fresh() -> None:
    """Run `scripts/venv python -m scripts.live` if this fails."""
    made, committed = live.build(PROGRAM), live.PAGE.read_text(encoding="utf-8")
    assert live.same(made, committed)
    assert not live.same(made, committed.replace("P / v.sn", "P / v.a"))


def test_stale_map() -> None:
    """A map with another sample is another page; the same map packed otherwise is not."""
    committed = live.PAGE.read_text(encoding="utf-8")
    blob = max(live.BLOB.findall(committed), key=len)
    plain = bytearray(zlib.decompress(base64.b64decode(blob)))
    other = base64.b64encode(zlib.compress(bytes(plain), 1)).decode()
    assert other != blob
    assert live.same(committed, committed.replace(blob, other))
    plain[-1] ^= 1
    assert not live.same(committed, committed.replace(blob, base64.b64encode(zlib.compress(bytes(plain))).decode()))


def test_one_file() -> None:
    """Small, without a network, and with the header's text as it is."""
    text = live.PAGE.read_text(encoding="utf-8")
    assert len(text.encode()) <= HEAVY
    assert live.HEADER.read_text(encoding="utf-8") in text
    assert re.findall(r"""(?:src|href)=["'](?!data:)|https?://|url\(|@import""", text) == []


def test_no_requests(driver: Chrome) -> None:
    asked = browser.requests(driver, live.PAGE)
    assert asked
    assert [url for url in asked if not url.startswith(browser.LOCAL)] == []


# The pictures ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", SCENES)
def test_pixels(driver: Chrome, tmp_path: Path, scene: str) -> None:
    """As kage's, by each method. What is left are shadow edges on which another order of sums decides, and, of the
    displaced ground, bumps thinner than a step at silhouettes."""
    start = {"scene": scene, "shade": False, "own": False}
    worst = {}
    for name, (method, changes, options) in METHODS.items():
        if APART.get(name, scene) != scene:
            continue
        found = pixels(driver, start | changes, method)
        worst[name] = share_near(found, kage(tmp_path, scene, *options))
        if name == "0":
            assert share_near(found, kage(tmp_path, scene, "--shadow", "none")) < 0.999, "order 0 is as `none`"
    assert {name: share for name, share in worst.items() if share < SHARE} == {}
    check_samples(driver, tmp_path, scene)
    check_turned(driver, tmp_path, scene)


def check_samples(driver: Chrome, tmp_path: Path, scene: str) -> None:
    """Of 2 x 2 a pixel, as the page draws once it stands."""
    found = pixels(driver, {"scene": scene, "shade": False, "own": False}, "1", samples=2)
    assert share_near(found, kage(tmp_path, scene, "--shadow", "1", "--aa", "2")) >= SHARE


def check_turned(driver: Chrome, tmp_path: Path, scene: str) -> None:
    """With another eye, light and height: kage draws the same from the numbers that the page says it has."""
    found = pixels(driver, {"scene": scene, "eye": [25, 6, 1.1], "light": [-30, -7], "height": 0.6, "own": False}, "2")
    u = driver.execute_script("return live.uniforms(4, 3);")
    changes = {"camera.from": u["eye_from"], "lights.*.at": u["light_at"], "objects.*.bump.scale": abs(u["scale"])}
    names = {"terrain": ("sun", "ground"), "sphere": ("lamp", "globe"), "cube": ("lamp", "ground")}[scene]
    options = ["--shadow", "2"]
    for key, value in changes.items():
        name = key.replace("lights.*", f"lights.{names[0]}").replace("objects.*", f"objects.{names[1]}")
        options += ["--set", f"{name}={json.dumps(value)}"]
    assert share_near(found, kage(tmp_path, scene, *options)) >= SHARE
    assert share_near(found, kage(tmp_path, scene, "--shadow", "2")) < SHARE


def test_shown(driver: Chrome, tmp_path: Path) -> None:
    """What is on the screen: `none` left of the line, order 0 right of it."""
    load(driver, "#line=0.6")
    driver.execute_script(  # whole pixels
        "const { style } = document.getElementById('stage'); scrollTo(0, 0);"
        "Object.assign(style, { position: 'fixed', left: 0, top: 0, width: '280px' });")
    settle(driver)
    size = driver.execute_script("const c = document.getElementById('canvas'); return [c.width, c.height];")
    assert size == [280, 210]
    shot = driver.execute_cdp_cmd("Page.captureScreenshot", {
        "clip": {"x": 0, "y": 0, "width": 280, "height": 210, "scale": 1}})["data"]
    (tmp_path / "shot.png").write_bytes(base64.b64decode(shot))
    with Image.open(tmp_path / "shot.png") as image:
        seen = np.asarray(image.convert("RGB")).astype(int)
    middle, free = slice(size[1] // 5, -8), 30  # without labels, corners and the line
    line = round(0.6 * size[0])
    for method, part in (("none", slice(8, line - free)), ("0", slice(line + free, size[0] - 8))):
        wanted = kage(tmp_path, "cube", "--shadow", method, "--aa", "2", size=tuple(size))
        once = kage(tmp_path, "cube", "--shadow", method, size=tuple(size))
        got = seen[middle, part]
        near = max(share_near(got, x[middle, part]) for x in (wanted, once))  # slow processors stay with one sample
        assert near >= SHARE, f"{method}: {near}"


# The controls ---------------------------------------------------------------------------------------------------


def choose(driver: Chrome, group: str, value: str) -> None:
    driver.execute_script("document.querySelector(arguments[0]).click();", f"#{group} input[value='{value}']")


def test_choices(driver: Chrome) -> None:
    """Each choice is the state, in the address, and in words; and the code that is shown has a line that is marked and
    is a line of the sources."""
    sources = "".join(path.read_text(encoding="utf-8") for path in (*live.PARTS.glob("*.glsl"), live.HEADER))
    lines = set(sources.split("\n"))
    names = ["none", "0", "1", "2", "2+", "march", "displaced"]
    assert driver.execute_script("return [...document.querySelectorAll('#right input')].map((x) => x.value);") == names
    marks = {}
    for name in names:
        choose(driver, "right", name)
        assert state(driver)["right"] == name
        marked, shown = driver.execute_script(
            "const of = (q) => [...document.querySelectorAll('.code-text ' + q)].map((x) => x.textContent);"
            "return [of('.on'), of('pre span')];")
        assert marked and not {line for line in shown if line != " "} - lines
        marks[name] = tuple(marked)
    assert len(set(marks.values())) == len(names), "two methods have the same lines"
    choose(driver, "right", "none")
    for scene in ("terrain", "sphere"):
        choose(driver, "scene", scene)
        assert state(driver)["scene"] == scene
    for box in ("shade", "own"):  # before a frame: it need not be drawn
        seen = driver.execute_script(
            "const box = document.getElementById(arguments[0]), seen = [];"
            "for (let i = 0; i < 2; i++) { box.click(); seen.push(live.state[arguments[0]]); }"
            "return seen;", box)
        assert seen == [True, False]
    driver.execute_script("live.set({line: 1, own: true, steps: 2, height: 0.5, eye: [5, -4, 1.2], light: [-10, 3]});")
    wait(driver, "['line=1', 'scene=sphere', 'own=1', 'right=none'].every((x) => location.hash.includes(x));")
    kept = state(driver)
    load(driver, driver.execute_script("return location.hash;"))
    assert state(driver) == kept


def test_keys(driver: Chrome) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    canvas, line = driver.find_element("id", "canvas"), driver.find_element("id", "divider")
    driver.execute_script("document.getElementById('canvas').focus();")
    before = pixels(driver, {}, "none")
    ActionChains(driver).send_keys(Keys.ARROW_LEFT, Keys.ARROW_UP).perform()
    assert state(driver)["eye"] == [3, -3, 1]
    assert share_near(pixels(driver, {}, "none"), before) < SHARE
    ActionChains(driver).key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT).key_up(Keys.SHIFT).perform()
    assert state(driver)["light"] == [3, 0]
    canvas.send_keys("m")
    assert state(driver)["right"] == "march"
    canvas.send_keys("n")
    assert state(driver)["right"] == "none"
    canvas.send_keys("+")
    assert state(driver)["eye"][2] < 1
    seen = driver.execute_script(  # before a frame: it need not be drawn
        "const { state } = live, seen = [], press = (key) => document.activeElement.dispatchEvent("
        "new KeyboardEvent('keydown', { key, bubbles: true }));"
        "for (const key of 'sbsb') { press(key); seen.push([state.shade, state.own]); }"
        "return seen;")
    assert seen == [[True, False], [True, True], [False, True], [False, False]]
    for key, wanted in ((Keys.ARROW_LEFT, 99), (Keys.PAGE_DOWN, 89), (Keys.HOME, 0), (Keys.END, 100)):
        line.send_keys(key)
        assert line.get_attribute("aria-valuenow") == str(wanted)
        assert state(driver)["line"] == wanted / 100
    canvas.send_keys("r")
    assert state(driver)["eye"] == [0, 0, 1]
    assert share_near(pixels(driver, {}, "none"), before) == 1


def drag(driver: Chrome, start: tuple[float, float], way: tuple[int, int], shift: bool = False) -> None:
    for kind, k in (("mousePressed", 0), ("mouseMoved", 0.5), ("mouseMoved", 1), ("mouseReleased", 1)):
        driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": start[0] + way[0] * k, "y": start[1] + way[1] * k, "button": "left",
            "buttons": int(kind != "mouseReleased"), "clickCount": 1, "modifiers": 8 if shift else 0})


def centre(driver: Chrome, id_: str) -> tuple[float, float]:
    x, y = driver.execute_script(
        "const e = document.getElementById(arguments[0]); e.scrollIntoView({block: 'center'});"
        "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2];", id_)
    return x, y


def test_mouse(driver: Chrome) -> None:
    x, y = centre(driver, "canvas")
    drag(driver, (x, y), (-60, 30))
    s = state(driver)
    assert s["eye"][0] > 5 and s["eye"][1] > 3 and s["light"] == [0, 0]
    drag(driver, (x, y), (60, -30), shift=True)
    assert state(driver)["light"][0] > 5 and state(driver)["light"][1] > 3
    assert state(driver)["eye"] == s["eye"]
    choose(driver, "drag", "light")
    drag(driver, (x, y), (-200, 0))
    assert state(driver)["light"][0] < 0
    drag(driver, (x, y), (0, 4000))  # far below the ground
    assert driver.execute_script("return live.uniforms(4, 3).light_at[1];") > 0
    driver.execute_script("live.set({line: 0.5});")
    x, y = centre(driver, "divider")
    drag(driver, (x, y), (-100, 0))
    width = driver.execute_script("return document.getElementById('canvas').clientWidth;")
    assert abs(state(driver)["line"] - (0.5 - 100 / width)) < 0.01
    driver.execute_script(
        "const e = document.getElementById('height'); e.value = 1.5; e.dispatchEvent(new Event('input'));")
    assert state(driver)["height"] == 1.5
    settle(driver)


def touch(driver: Chrome, starts: list[tuple[float, float]], way: tuple[int, int]) -> None:
    for i in range(5):
        points = [{"x": x + way[0] * i / 4, "y": y + way[1] * i / 4, "id": k} for k, (x, y) in enumerate(starts)]
        driver.execute_cdp_cmd("Input.dispatchTouchEvent",
                               {"type": "touchMove" if i else "touchStart", "touchPoints": points})
    driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_phone(page: Chrome) -> None:
    """No sideways scroll; one finger turns the eye, two the light, and one moves the line."""
    load(page, "#line=0.5", PHONE, phone=True)
    page.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
    for scene in SCENES:
        wide = page.execute_script(
            "live.set({scene: arguments[0], right: 'march', own: true});"  # with all sliders
            "const wide = document.documentElement.scrollWidth;"
            "live.set({right: 'none', own: false}); return wide;", scene)
        assert wide <= PHONE[0]
    x, y = centre(page, "canvas")
    x += 60
    touch(page, [(x, y)], (-40, 20))
    s = state(page)
    assert s["eye"][0] > 3 and s["light"] == [0, 0]
    touch(page, [(x, y), (x + 50, y)], (40, 0))
    assert state(page)["light"][0] > 3
    assert state(page)["eye"] == pytest.approx(s["eye"], abs=0.2)
    x, y = centre(page, "divider")
    touch(page, [(x, y)], (60, 0))
    assert state(page)["line"] > 0.6
    assert messages(page) == []


# What is not as usual -------------------------------------------------------------------------------------------


def shown(driver: Chrome, id_: str) -> bool:
    return driver.execute_script(
        "const e = document.getElementById(arguments[0]);"
        "return e.checkVisibility() && e.getBoundingClientRect().width > 100;", id_)


@contextlib.contextmanager
def before_the_page(driver: Chrome, script: str) -> Iterator[None]:
    id_ = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": script})["identifier"]
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": id_})


@pytest.mark.parametrize(("script", "why"), [
    ("HTMLCanvasElement.prototype.getContext = () => null;", "WebGL"),
    ("delete globalThis.DecompressionStream;", "DecompressionStream"),
])
def test_old_browser(page: Chrome, script: str, why: str) -> None:
    """The picture by kage, and why."""
    with before_the_page(page, script):
        browser.resize(page, PHONE, phone=True)
        page.get("about:blank")
        browser.open_page(page, live.PAGE)
    wait(page, "!document.getElementById('notice').hidden;")
    assert why in page.find_element("id", "notice").text
    assert shown(page, "still") and not shown(page, "canvas") and not shown(page, "divider")
    assert browser.bad_images(page) == []
    assert browser.sideways(page) <= 0
    choose(page, "right", "march")  # the rest goes on
    assert state(page)["right"] == "march"
    assert messages(page) == []


def test_lost(driver: Chrome) -> None:
    """The card is lost, then there again."""
    driver.execute_script("globalThis.card = document.getElementById('canvas').getContext('webgl2')"
                          ".getExtension('WEBGL_lose_context'); card.loseContext();")
    wait(driver, "document.getElementById('canvas').hidden;")
    assert shown(driver, "still")
    count = driver.execute_script("card.restoreContext(); return live.frame.count;")
    wait(driver, "live.frame.count > arguments[0] && !document.getElementById('canvas').hidden;", count)
    assert driver.find_element("id", "notice").text == ""
    browser.errors(driver)  # the browser itself says that the context was lost


def test_motion(page: Chrome) -> None:
    """The line moves at the start, but for who wants no motion."""
    with before_the_page(page, "setInterval(() => { globalThis.moved ||= globalThis.live?.frame.moves; }, 1);"):
        load(page, "")
        assert page.execute_script("return moved;") is True
        assert state(page)["line"] == 0.5
        page.execute_cdp_cmd("Emulation.setEmulatedMedia",
                             {"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]})
        page.get("about:blank")
        page.get(live.PAGE.as_uri())
        settle(page)
        assert page.execute_script("return moved;") is False
        page.find_element("id", "play").click()  # who asks for it has it
        wait(page, "live.state.light[0] !== 0;")
        page.find_element("id", "play").click()
        assert state(page)["light"] == [0, 0]


def test_looks(driver: Chrome) -> None:
    """Dark and light, every control with a name, no id twice, no sideways scroll."""
    browser.resize(driver, DESKTOP)
    assert browser.background(driver, "light") != browser.background(driver, "dark")
    assert browser.repeated_ids(driver) == []
    assert browser.sideways(driver) <= 0
    nameless = driver.execute_script(
        "const all = document.querySelectorAll('input, button, [role=slider], [role=application], [role=region]');"
        "const name = (e) => (e.closest('label') ?? e).textContent.trim() || e.getAttribute('aria-label');"
        "return [...all].filter((e) => !name(e)).map((e) => e.outerHTML.slice(0, 200));")
    assert nameless == []
