"""Pages and pictures of motions and robots."""

import base64
import html
import json
import pickle
import re
import struct

import hamel
import numpy as np
import pytest
from conftest import PANDA, SCENES
from test_motion import PENDULUM

MESH = """<robot name="box">
  <link name="base"/>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="arm.stl"/></geometry></visual>
  </link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""


@pytest.fixture(scope="module")
def motion():
    return hamel.simulate(hamel.load(PENDULUM), 2.0, sample_step=0.5)


def header(page):
    """What a page is told of the mechanism."""
    found = re.search(r'<script type="application/json" id="header">(.*?)</script>', page, re.DOTALL)
    return json.loads(found.group(1))


def numbers(page):
    """The bytes of the recorded numbers of a page."""
    return base64.b64decode(re.search(r'id="numbers">([A-Za-z0-9+/=\s]*)<', page).group(1))


def test_a_page_holds_the_motion(motion):
    page = motion.to_html()
    told = header(page)
    assert page.startswith("<!doctype html>")
    assert (told["name"], told["frames"]) == ("pendulum", 5)
    assert f"estimated error at the end {motion.end_error:.1e}" in told["method"]
    titles = [chart["title"] for chart in told["charts"]]
    assert "Energy drift" in titles and "Estimated error" in titles and "Integration steps" not in titles
    # Times come first, as doubles; then kinetic energy, as single precision.
    data = numbers(page)
    assert np.frombuffer(data, "<f8", 5).tolist() == motion.t.tolist()
    assert np.frombuffer(data, "<f4", 5, 40).tolist() == motion.kinetic_energy.astype("f4").tolist()


def test_efforts_change_the_energy():
    robot = hamel.load(PENDULUM)
    pushed = hamel.simulate(robot, 0.1, inputs=lambda time, q, v: [1.0], estimate=False)
    titles = [chart["title"] for chart in header(pushed.to_html())["charts"]]
    assert "Energy change" in titles and "Estimated error" not in titles


def test_files_are_what_their_ending_says(motion, tmp_path):
    for ending, start in {"html": b"<!doctype html>", "svg": b"<!-- hamel simulate, picture -->", "png": b"\x89PNG\r\n\x1a\n", "gif": b"GIF89a"}.items():
        path = tmp_path / f"motion.{ending}"
        motion.save(path, instants=np.int64(3))
        assert path.read_bytes().startswith(start)
    width, height = struct.unpack(">II", (tmp_path / "motion.png").read_bytes()[16:24])
    assert (width, height) == (960, 640)
    motion.save(str(tmp_path / "again.SVG"))
    # One instant instead of three.
    assert (tmp_path / "again.SVG").stat().st_size < (tmp_path / "motion.svg").stat().st_size


def test_wrong_endings_and_instants_are_refused(motion, tmp_path):
    for name in ("motion.pdf", "motion", ".html"):
        with pytest.raises(hamel.ArgumentError, match=r"it must end in \.html, \.svg, \.png or \.gif"):
            motion.save(tmp_path / name)
    for instants in (0, 51, 2.5):
        with pytest.raises(hamel.ArgumentError, match=f"instants is {instants}: it must be an integer from 1 to 50"):
            motion.save(tmp_path / "motion.png", instants=instants)
    assert not list(tmp_path.iterdir())
    none = hamel.simulate(hamel.load(PENDULUM), 1.0, samples=[], estimate=False)
    for show in (none.to_html, lambda: none.save(tmp_path / "none.png")):
        with pytest.raises(hamel.ArgumentError, match="the motion has no samples"):
            show()
    assert none._repr_html_() is None


def test_notebooks_show_motions_and_robots(motion):
    frame = motion._repr_html_()
    assert html.unescape(re.search(r'srcdoc="([^"]*)"', frame).group(1)) == motion.to_html()
    shown = motion.robot._repr_html_()
    image = re.search(r'src="data:image/svg\+xml;base64,([^"]*)"', shown).group(1)
    assert b"<svg" in base64.b64decode(image) and "<table>" in shown


def test_meshes_beside_a_robot_are_shown(tmp_path):
    (tmp_path / "robot.urdf").write_text(MESH)
    without = hamel.load(tmp_path / "robot.urdf")._repr_html_()
    assert "image/svg+xml" in without
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    solid = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in corners[corner]), 0) for face in faces)
    (tmp_path / "arm.stl").write_bytes(bytes(80) + struct.pack("<I", len(faces)) + solid)
    robot = hamel.load(tmp_path / "robot.urdf")
    assert "image/png" in robot._repr_html_()
    page = hamel.simulate(robot, 0.1).to_html()
    assert len(header(page)["meshes"]) == 1
    # A pickle is the text, without the folder.
    assert "image/svg+xml" in pickle.loads(pickle.dumps(robot))._repr_html_()


@pytest.mark.parametrize("path", [PANDA, SCENES / "rolling_disk.toml", SCENES / "humanoid.toml"])
def test_robots_and_scenes_have_pages(path):
    robot = hamel.load(path)
    motion = hamel.simulate(robot, 0.05, sample_step=0.01, estimate=False)
    told = header(motion.to_html())
    assert told["frames"] > 1 and len(told["bodies"]) == len(robot.bodies)
