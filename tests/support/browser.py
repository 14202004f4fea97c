"""A page in headless Chromium: what is wrong with it, and its slider moved by keys, pointer and finger.

`check_page(path)` is for any page of bench/report.py, made-up or real. Without Chromium or selenium a test is skipped,
but not in CI.
"""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

CHROMIUM = Path("/usr/bin/chromium")
CHROMEDRIVER = Path("/usr/bin/chromedriver")
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
           "--disable-background-networking", "--disable-component-update", "--disable-sync")
WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")  # WebGL 2 by the processor
DESKTOP, PHONE = (1280, 900), (390, 844)
LOCAL = ("file:", "data:")


@contextlib.contextmanager
def browser(script: bool = True, webgl: bool = False) -> Iterator[Chrome]:
    """Chromium with a profile of its own; nothing is downloaded. `script=False` turns JavaScript off."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is missing")
    from selenium.webdriver.chrome.service import Service

    for program in (CHROMIUM, CHROMEDRIVER):
        if not os.access(program, os.X_OK):
            missing = pytest.fail if os.environ.get("CI") else pytest.skip  # CI must have it
            missing(f"{program} is missing (Debian: chromium, chromium-driver)")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        options = webdriver.ChromeOptions()
        options.binary_location = str(CHROMIUM)
        for option in (*OPTIONS, *(WEBGL if webgl else ()), f"--user-data-dir={profile}"):
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        if not script:
            options.add_experimental_option("prefs", {"profile.managed_default_content_settings.javascript": 2})
        driver = webdriver.Chrome(options=options, service=Service(str(CHROMEDRIVER)))
        try:
            yield driver
        finally:
            driver.quit()


def resize(driver: Chrome, size: tuple[int, int], phone: bool = False) -> None:
    """By emulation: a headless window has a least width."""
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": phone})
    driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": phone, "maxTouchPoints": 1})


def open_page(driver: Chrome, path: Path) -> None:
    driver.get(path.resolve().as_uri())
    driver.execute_async_script(  # images are decoded beside the script
        "const done = arguments[0];"
        "Promise.allSettled([...document.images].map((i) => i.decode())).then(() => done());")


def requests(driver: Chrome, path: Path) -> list[str]:
    """The addresses that the page asked for since this was last called, itself among them; not those of the browser's
    own start page."""
    messages = (json.loads(entry["message"])["message"] for entry in driver.get_log("performance"))
    sent = (message["params"] for message in messages if message["method"] == "Network.requestWillBeSent")
    return [params["request"]["url"] for params in sent if params["documentURL"].startswith(path.resolve().as_uri())]


def errors(driver: Chrome) -> list[str]:
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]


def bad_images(driver: Chrome) -> list[str]:
    return driver.execute_script(
        "return [...document.images].filter((i) => !i.complete || i.naturalWidth === 0 || !i.hasAttribute('alt'))"
        ".map((i) => i.outerHTML.slice(0, 200));")


def repeated_ids(driver: Chrome) -> list[str]:
    return driver.execute_script(
        "const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);"
        "return ids.filter((id, i) => ids.indexOf(id) !== i);")


def sideways(driver: Chrome) -> int:
    """By how many pixels the page is wider than the window."""
    return driver.execute_script(
        "const page = document.documentElement;"
        "return Math.max(page.scrollWidth, document.body.scrollWidth) - page.clientWidth;")


def background(driver: Chrome, scheme: str) -> str:
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                           {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    return driver.execute_script("return getComputedStyle(document.body).backgroundColor;")


# The slider -----------------------------------------------------------------------------------------------------


def split_of(driver: Chrome, form: str = ".comparison") -> float:
    """What the range says; what is drawn must say the same."""
    value, drawn = driver.execute_script(
        "const f = document.querySelector(arguments[0]);"
        "const stage = f.querySelector('.stage').getBoundingClientRect();"
        "const line = f.querySelector('.line').getBoundingClientRect();"
        "return [Number(f.elements.split.value), (line.left + line.width / 2 - stage.left) / stage.width * 100];", form)
    assert abs(value - drawn) < 0.6, f"the range is at {value} %, the border at {drawn} %"
    return value


def stage_point(driver: Chrome, share: float) -> tuple[float, float]:
    """A place on the picture, in the window's pixels; the picture is brought into the window."""
    x, y = driver.execute_script(
        "const s = document.querySelector('.stage'); s.scrollIntoView({block: 'center'});"
        "const b = s.getBoundingClientRect(); return [b.left + b.width * arguments[0], b.top + b.height / 2];", share)
    return x, y


def drag_mouse(driver: Chrome, start: float, end: float) -> None:
    for kind, share in (("mousePressed", start), ("mouseMoved", (start + end) / 2), ("mouseMoved", end),
                        ("mouseReleased", end)):
        x, y = stage_point(driver, share)
        driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": x, "y": y, "button": "left", "buttons": int(kind != "mouseReleased"), "clickCount": 1})


def drag_finger(driver: Chrome, start: float, end: float) -> None:
    steps = [start + (end - start) * i / 6 for i in range(7)]
    for i, share in enumerate(steps):
        x, y = stage_point(driver, share)
        driver.execute_cdp_cmd("Input.dispatchTouchEvent",
                               {"type": "touchMove" if i else "touchStart", "touchPoints": [{"x": x, "y": y}]})
    driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def check_slider(driver: Chrome) -> None:
    """By keys, by pointer, by choice of scene and method."""
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.select import Select

    form = driver.find_element(By.CSS_SELECTOR, ".comparison")
    split = form.find_element(By.NAME, "split")
    for key, expected in (("HOME", 0), ("ARROW_RIGHT", 1), ("ARROW_RIGHT", 2), ("ARROW_LEFT", 1), ("END", 100)):
        split.send_keys(getattr(Keys, key))
        assert split_of(driver) == expected, f"after {key} the slider is at {split_of(driver)}, not {expected}"
    drag_mouse(driver, 0.8, 0.3)
    assert abs(split_of(driver) - 30) <= 1, f"dragged to 30 %, the slider is at {split_of(driver)}"

    def sources(side: str) -> list[str | None]:
        return [i.get_attribute("src") for i in form.find_elements(By.CSS_SELECTOR, f".side.{side} img")]

    for name in ("left", "right", "scene"):
        select = Select(form.find_element(By.NAME, name))
        if len(select.options) < 2:
            continue
        before = sources("left") + sources("right")
        chosen = select.first_selected_option.text
        select.select_by_visible_text(next(o.text for o in reversed(select.options) if o.text != chosen))
        assert sources("left") + sources("right") != before, f"another {name} shows the same pictures"
    assert form.find_element(By.CSS_SELECTOR, "[data-name=left]").text == Select(form.find_element(By.NAME, "left")
                                                                                  ).first_selected_option.text
    wrong = form.find_element(By.NAME, "wrong")
    Select(form.find_element(By.NAME, "left")).select_by_visible_text("bump only")
    for shown in (True, False):
        wrong.click()
        over = form.find_elements(By.CSS_SELECTOR, ".side.left .over")
        assert [o.value_of_css_property("display") != "none" for o in over] == [shown] * len(over)


def check_touch(driver: Chrome) -> None:
    drag_finger(driver, 0.3, 0.7)
    assert abs(split_of(driver) - 70) <= 2, f"dragged by a finger to 70 %, the slider is at {split_of(driver)}"


# The page -------------------------------------------------------------------------------------------------------


def none_of(what: str, found: list[str]) -> None:
    assert not found, f"{what}: {found}"


def check_page(path: Path) -> None:
    """No error, no request, every picture there, no sideways scroll, a slider that moves, dark and light."""
    with browser() as driver:
        resize(driver, DESKTOP)
        open_page(driver, path)
        none_of("images without picture or text", bad_images(driver))
        none_of("ids given twice", repeated_ids(driver))
        assert sideways(driver) <= 0, f"{DESKTOP[0]} px: the page is {sideways(driver)} px too wide"
        light, dark = background(driver, "light"), background(driver, "dark")
        assert light != dark, f"dark and light both have {light}"
        has_slider = driver.execute_script("return document.querySelector('.comparison') !== null;")
        if has_slider:
            check_slider(driver)
        resize(driver, PHONE, phone=True)
        assert sideways(driver) <= 0, f"{PHONE[0]} px: the page is {sideways(driver)} px too wide"
        if has_slider:
            check_touch(driver)
        none_of("images without picture or text", bad_images(driver))
        asked = requests(driver, path)
        assert asked, "the browser's log tells of no request, not even for the page"
        none_of("requests", [url for url in asked if not url.startswith(LOCAL)])
        none_of("messages of the console", errors(driver))
