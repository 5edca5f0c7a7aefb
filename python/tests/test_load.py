"""Files and texts, what is known of robots, and what is said of bad files."""

import pickle
from pathlib import Path

import hamel
import numpy as np
import pytest
from conftest import PANDA, ROOT, SCENES

BAD = sorted((ROOT / "tests/corpus/scenes-bad").glob("*.toml")) + sorted((ROOT / "tests/corpus/urdf-bad").glob("*.urdf"))


def test_paths_and_texts_give_the_same():
    text = PANDA.read_text()
    in_one_line = text.replace("\n", " ").strip()
    robots = [hamel.load(source) for source in (PANDA, str(PANDA), text, in_one_line)]
    q = np.linspace(0.1, 0.7, 7)
    masses = [robot.mass_matrix(q) for robot in robots]
    assert all(np.array_equal(mass, masses[0]) for mass in masses)
    scene = SCENES / "mixed_tree.toml"
    assert hamel.load(scene.read_text()).joints == hamel.load(scene).joints


def test_robots_in_mjcf_are_read():
    robot = hamel.load(ROOT / "tests/data/mjcf/pendulum.xml")
    assert robot.sizes.speeds == len(robot.joints) == 1
    # The rates that MuJoCo finds are compared in the tests of Rust; here it is enough that it falls.
    q = robot.configuration([0.3])
    assert np.isfinite(robot.forward_dynamics(q, [0.0], [0.0])).all()


def test_what_stands_beside_a_robot_is_read(tmp_path):
    link = '<link name="{}"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    names = ("base", "crank", "coupler", "rocker")
    hinge = '<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{2}"/><origin xyz="{3} 0 0"/><axis xyz="0 0 1"/></joint>'
    joints = (("a", "base", "crank", 0.0), ("b", "crank", "coupler", 0.12), ("c", "base", "rocker", 0.3))
    frames = '<link name="end_1"/><link name="end_2"/>' + "".join(
        f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{name}"/><origin xyz="{x} 0 0"/></joint>'
        for name, parent, x in (("end_1", "coupler", 0.35), ("end_2", "rocker", 0.25))
    )
    text = "".join(link.format(name) for name in names) + "".join(hinge.format(*joint) for joint in joints) + frames
    path = tmp_path / "four_bar.urdf"
    path.write_text(f'<robot name="four_bar">{text}</robot>')
    assert hamel.load(path).sizes.speeds == 3
    (tmp_path / "four_bar.yaml").write_text("closed_loop: [[end_1, end_2]]\ntype: [3d]\nname_mot: [a]\n")
    assert hamel.load(path).sizes.speeds == 1


def test_names_sizes_and_limits(panda):
    assert panda.name == "panda"
    assert panda.joints == tuple(f"panda_joint{i}" for i in range(1, 8))
    assert panda.bodies == tuple(f"panda_link{i}" for i in range(1, 8))
    assert "panda_hand_tcp" in panda.frames
    assert panda.sizes == hamel.Sizes(configuration=7, freedoms=7, speeds=7)
    joint = panda.joint("panda_joint4")
    assert (joint.type, joint.parent, joint.bodies) == ("revolute", "panda_link3", ("panda_link4",))
    assert (joint.configuration, joint.units, joint.effort_units) == (slice(3, 4, 1), ("rad",), ("N m",))
    assert joint.limits == hamel.Limits(lower=-3.0718, upper=-0.0698, velocity=2.175, effort=87.0)
    assert panda.limits["panda_joint4"] == joint.limits
    assert any("limits of position are not simulated" in notice for notice in panda.notices)
    assert panda.source == PANDA.read_text()


def test_a_state_is_that_of_the_file():
    robot = hamel.load(SCENES / "mixed_tree.toml")
    state = robot.state()
    assert state.time == 0.0
    assert state.speeds[robot.joint("rail").speeds].tolist() == [0.5]
    assert robot.positions(state.configuration)[robot.joint("rail").freedoms].tolist() == [0.1]


def test_a_base_moves_freely_where_that_is_asked_for():
    path = ROOT / "tests/data/urdf/anymal.urdf"
    fixed, free = hamel.load(path), hamel.load(path, floating_base=True)
    assert free.sizes.speeds == fixed.sizes.speeds + 6
    with pytest.raises(hamel.ArgumentError, match="floating_base is True: only robots in URDF"):
        hamel.load(SCENES / "mixed_tree.toml", floating_base=True)


def test_a_robot_begins_in_its_posture():
    robot = hamel.load(PANDA, posture={"panda_joint2": -0.5, "panda_joint4": -2.0})
    begun = robot.positions(robot.state().configuration)
    assert begun.tolist() == [0.0, -0.5, 0.0, -2.0, 0.0, 0.0, 0.0]
    kept = pickle.loads(pickle.dumps(robot))
    assert kept.state().configuration.tolist() == robot.state().configuration.tolist()
    with pytest.raises(hamel.FileError, match="there is no joint `panda_joint9`"):
        hamel.load(PANDA, posture={"panda_joint9": 1.0})
    with pytest.raises(hamel.ArgumentError, match="posture is .* it must be a dict"):
        hamel.load(PANDA, posture=[1.0])
    with pytest.raises(hamel.ArgumentError, match="posture is for robots in URDF, MJCF and SDF"):
        hamel.load(SCENES / "mixed_tree.toml", posture={"rail": 1.0})


def test_a_robot_begins_in_a_state_of_an_srdf(tmp_path):
    file = tmp_path / "panda.urdf"
    file.write_text(PANDA.read_text())
    state = '<robot name="panda"><group_state name="ready" group="arm"><joint name="panda_joint4" value="-2"/></group_state></robot>'
    elsewhere = tmp_path / "states.srdf"
    elsewhere.write_text(state)
    with pytest.raises(hamel.ArgumentError, match="posture is .ready.: say by srdf which SRDF"):
        hamel.load(file, posture="ready")
    given = hamel.load(PANDA.read_text(), posture="ready", srdf=elsewhere)
    file.with_suffix(".srdf").write_text(state)
    beside = hamel.load(file, posture="ready")
    for robot in (given, beside, pickle.loads(pickle.dumps(beside))):
        assert robot.positions(robot.state().configuration).tolist() == [0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0]
    with pytest.raises(hamel.FileError, match="the SRDF has no state `reddy`"):
        hamel.load(file, posture="reddy")
    with pytest.raises(hamel.ArgumentError, match="srdf is for a posture that is the name of a state"):
        hamel.load(file, posture={"panda_joint4": -2.0}, srdf=elsewhere)
    with pytest.raises(hamel.ArgumentError, match="posture is for robots in URDF, MJCF and SDF"):
        hamel.load(SCENES / "mixed_tree.toml", posture="ready")


def test_broken_masses_are_read_leniently():
    text = '''<robot name="a">
<link name="base"/>
<link name="arm"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit effort="1" velocity="1" lower="-1" upper="1"/></joint>
</robot>'''
    with pytest.raises(hamel.FileError):
        hamel.load(text)
    robot = hamel.load(text, lenient=True)
    assert robot.mass_matrix([0.0])[0, 0] == pytest.approx(11 / 3)
    assert any("arm" in notice for notice in robot.notices)
    with pytest.raises(hamel.ArgumentError, match="lenient is True: only robots in URDF"):
        hamel.load(SCENES / "mixed_tree.toml", lenient=True)


def test_mistakes_are_told_with_their_lines():
    text = 'hamel = 1\nname = "a"\n[[body]]\nname = "b"\nparent = "c"\nmass = -1\njoint = { type = "revolut" }\n'
    with pytest.raises(hamel.FileError) as caught:
        hamel.load(text)
    error = caught.value
    assert error.source == "text"
    lines = {mistake.line for mistake in error.mistakes}
    assert {5, 7} <= lines
    assert any("revolut" in mistake.message for mistake in error.mistakes)
    assert "text:7:" in str(error) and 'joint = { type = "revolut" }' in str(error)


# Read as a text of the other format, or empty: refused, with another message.
OTHERWISE = {"xml.toml", "xml_empty.urdf"}


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.name)
def test_bad_files_are_told_as_the_program_tells_them(path):
    with pytest.raises(hamel.FileError) as caught:
        hamel.load(path, floating_base=path.name.startswith("floating_"))
    assert caught.value.mistakes
    if path.name not in OTHERWISE:
        first = path.with_suffix(".expected").read_text().splitlines()[0]
        assert first.removeprefix("error: ") in str(caught.value)


@pytest.mark.parametrize("path", [PANDA, SCENES / "mixed_tree.toml", ROOT / "tests/data/scenes/loops.toml"], ids=lambda path: path.name)
def test_texts_that_end_anywhere_are_refused_or_read(path):
    """Never with another exception, and never by a panic."""
    text = path.read_text()
    refused = 0
    for end in np.random.default_rng(5).integers(1, len(text), 60):
        try:
            robot = hamel.load(text[:end] + "\n")
            robot.mass_matrix(robot.state().configuration)
        except hamel.Error as error:
            refused += isinstance(error, hamel.FileError)
    assert refused > 30


def test_what_is_no_file_is_told(tmp_path):
    with pytest.raises(hamel.FileError, match="cannot read .*nowhere.urdf"):
        hamel.load(tmp_path / "nowhere.urdf")
    with pytest.raises(hamel.FileError):
        hamel.load("")
    with pytest.raises(hamel.FileError):
        hamel.load(tmp_path)
    with pytest.raises(hamel.FileError, match="nul|NUL|null"):
        hamel.load("a\0b")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(hamel.FileError):
        hamel.load(tmp_path / "binary.toml")
    for wrong in (None, 3, b"\xff", ["a"]):
        with pytest.raises((hamel.ArgumentError, hamel.FileError)):
            hamel.load(wrong)


def test_robots_are_told_in_words_and_as_a_table(panda):
    assert repr(panda) == '<hamel.Robot "panda": 7 joints, 7 bodies, 7 entries of q, 7 speeds>'
    table = panda._repr_html_()
    assert table.count("<table>") == 1 and table.count("<tr>") == 8
    assert "<td>-3.0718 to -0.0698</td>" in table
    text = (SCENES / "mixed_tree.toml").read_text().replace('name = "mixed_tree"', 'name = "<b>&"')
    assert "<caption>&lt;b&gt;&amp;</caption>" in hamel.load(text)._repr_html_()
