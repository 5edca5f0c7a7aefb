"""Pages as a browser shows them: light, dark, and as wide as a phone. CHROMIUM names a Chromium, else one on the PATH is taken. How pages answer to clicks and keys, `tests/browser` looks at.

With HAMEL_ROBOTS, a folder of robots with meshes (`pip install example-robot-data` has one), the pages of its robots are looked at as well, and with HAMEL_SCREENS the pictures are kept in that folder.
"""

import base64
import os
import shutil
import subprocess
import sys
from pathlib import Path

import hamel
import numpy as np
import pytest
from conftest import PENDULUM, ROOT, SCENES

playwright = pytest.importorskip("playwright.sync_api", reason="pages are shown by it: pip install playwright")

BROWSER = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="there is no Chromium: apt-get install chromium")

# A screen, a dark one, and a phone held upright.
VIEWS = {"light": (1280, 800, "light"), "dark": (1280, 800, "dark"), "phone": (390, 844, "light")}

ROBOTS = {
    "meshes": ROOT / "tests/data/mjcf/meshes.xml",
    "gripper": ROOT / "tests/data/mjcf/gripper.xml",
    "panda": ROOT / "tests/data/urdf/panda7.urdf",
    "anymal": ROOT / "tests/data/urdf/anymal.urdf",
    "rolling_disk": SCENES / "rolling_disk.toml",
}

# Of `example-robot-data`, those that HAMEL_ROBOTS has: an arm, a quadruped, two humanoids and a hand.
MESHES = ["panda_description/urdf/panda.urdf", "anymal_b_simple_description/robots/anymal.urdf", "talos_data/robots/talos_reduced.urdf", "icub_description/robots/icub.urdf", "allegro_hand_description/urdf/allegro_right_hand.urdf"]

# Its page has bands over time.
SAMPLED = "arm"

SWEEPS = {
    SAMPLED: (SCENES / "sweep/arm.toml", SCENES / "sweep/tolerances.csv"),
    "pendulum": (PENDULUM, "body.lower.mass,body.upper.initial.configuration.1\n" + "".join(f"{0.8 + 0.01 * row},{0.02 * row}\n" for row in range(40))),
    "failures": (PENDULUM, "body.lower.mass\n" + "".join(f"{0.01 * (row - 5)}\n" for row in range(40))),
}


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as started:
        shown = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        yield shown
        shown.close()


def moved(path, page):
    """Writes the page of a motion of a tenth of a second."""
    hamel.simulate(hamel.load(path), t_end=0.1, sample_step=0.01, estimate=False).save(page)


def swept(name, folder):
    """The page of a sweep."""
    scene, table = SWEEPS[name]
    if isinstance(table, str):
        path = folder / "table.csv"
        path.write_text(table)
        table = path
    options = [scene, "--over", table, "-o", folder / "out", "--no-error-estimate"]
    if name == SAMPLED:
        options += ["--sample-step", "0.02"]
    subprocess.run([sys.executable, "-m", "hamel", "sweep", *options], capture_output=True, timeout=300)
    return folder / "out/summary.html"


def shown(browser, page, view, name):
    """What a browser tells of a page: faults, widths, the background's lightness from 0 to 1, and the painted parts."""
    width, height, scheme = VIEWS[view]
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
    tab, faults = context.new_page(), []
    tab.on("pageerror", lambda error: faults.append(str(error)))
    tab.on("console", lambda told: faults.append(told.text) if told.type == "error" else None)
    tab.on("request", lambda asked: None if asked.url.startswith(("file:", "data:", "blob:")) else faults.append(asked.url))
    tab.goto(page.as_uri())
    # The picture is drawn in the next frames.
    tab.wait_for_timeout(500)
    found = tab.evaluate("""() => {
        const [red, green, blue] = getComputedStyle(document.body).backgroundColor.match(/[0-9.]+/g).map(Number);
        const bars = [...document.querySelectorAll("svg rect")].filter(bar => bar.getBoundingClientRect().height > 0).length;
        return {lightness: (red + green + blue) / 765, width: document.documentElement.scrollWidth, bars, text: document.body.innerText};
    }""")
    stage = tab.locator("canvas#stage")
    found["colours"] = colours(context, stage.screenshot()) if stage.count() else 0
    if folder := os.environ.get("HAMEL_SCREENS"):
        Path(folder).mkdir(parents=True, exist_ok=True)
        tab.screenshot(path=Path(folder) / f"{name}-{view}.png")
    context.close()
    return found, faults


def colours(context, picture):
    """How many colours a PNG has."""
    tab = context.new_page()
    return tab.evaluate(
        """async data => {
        const image = new Image();
        image.src = "data:image/png;base64," + data;
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
        canvas.drawImage(image, 0, 0);
        const found = canvas.getImageData(0, 0, image.width, image.height).data;
        return new Set(new Uint32Array(found.buffer)).size;
    }""",
        base64.b64encode(picture).decode(),
    )


def check(found, faults, view):
    assert faults == []
    assert found["width"] <= VIEWS[view][0], "the page is wider than the screen"
    assert (found["lightness"] < 0.3) if view == "dark" else (found["lightness"] > 0.7)


def robots():
    """Those of the project, and those of HAMEL_ROBOTS."""
    given = os.environ.get("HAMEL_ROBOTS")
    others = {} if not given else {Path(own).parts[0]: Path(given) / own for own in MESHES}
    return {**ROBOTS, **others}


@pytest.mark.parametrize("name", robots())
def test_motions_are_drawn(browser, name, tmp_path):
    moved(robots()[name], tmp_path / "page.html")
    for view in VIEWS:
        found, faults = shown(browser, tmp_path / "page.html", view, name)
        check(found, faults, view)
        # Surfaces are shaded; a page without a picture has the colour of its ground alone.
        assert found["colours"] > 50, view


@pytest.mark.parametrize("name", SWEEPS)
def test_sweeps_are_drawn(browser, name, tmp_path):
    page = swept(name, tmp_path)
    for view in VIEWS:
        found, faults = shown(browser, page, view, f"sweep-{name}")
        check(found, faults, view)
        assert found["bars"] >= 20, view
        assert "energy_J" in found["text"]
        assert ("elbow.q.q_rad over time" in found["text"]) == (name == SAMPLED)


def test_a_page_that_is_empty_is_seen(browser, tmp_path):
    """What the other tests ask for is missing where nothing is drawn."""
    page = tmp_path / "page.html"
    page.write_text('<!doctype html><body style="background:#fff"><canvas id="stage" width="2000"></canvas><script>undefined_name()</script>')
    found, faults = shown(browser, page, "phone", "empty")
    assert found["colours"] == 1 and found["bars"] == 0 and found["width"] > 390
    assert faults and np.isclose(found["lightness"], 1.0)
