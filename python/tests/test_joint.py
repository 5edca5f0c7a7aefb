"""Joints from a spec, and robots that have them."""

import copy
import pickle
import threading

import hamel
import numpy as np
import pytest
from conftest import ROOT

SPECS = ROOT / "joint-specs"

PIN_SLOT = """hamel = 1;

/// A pin in a slot & more.
joint pin_slot(
    /// How far the slot is above the parent.
    height: m >= 0,
) {
    config  theta: R1, x: R1;
    H     = trans([x, 0, height]) * rot_z(theta);
}
"""

SCENE = """hamel = 1
name = "two"
gravity = [0.0, -9.81, 0.0]
[[body]]
name = "slot"
parent = "world"
mass = 1.5
com = [0.1, 0.2, 0.0]
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
joint = { type = "TYPE", name = "first" }
[[body]]
name = "arm"
parent = "slot"
mass = 1.0
com = [0.3, 0.0, 0.0]
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
joint = { type = "TYPE", name = "second" }
[simulation]
t_end = 1.0
"""


def own(name, called):
    """A joint of the library under another name."""
    text = (SPECS / f"{name}.joint").read_text()
    return hamel.Joint(text.replace(f"joint {name}", f"joint {called}"))


@pytest.fixture(scope="module")
def ball():
    return hamel.Joint("ball")


def test_a_joint_tells_what_it_is():
    joint = hamel.Joint(PIN_SLOT)
    assert repr(joint).startswith('<hamel.Joint "pin_slot": 2 entries of q, 2 freedoms, 2 speeds, ')
    assert joint.coordinates == joint.freedoms == joint.speeds == ("theta", "x")
    assert joint.bodies == () and joint.exceptions == () and joint.evaluation == "interpreted"
    assert joint.description == "A pin in a slot & more."
    (height,) = joint.parameters
    assert height == ("height", "m", "How far the slot is above the parent.", 0.0, None)
    claims = {claim.name: claim for claim in joint.claims}
    assert claims["pose_in_se3"].proof == "normal_form" and claims["pose_in_se3"].points == 0
    assert hamel.Joint("slider_crank").bodies == ("crank", "rod", "slider")
    assert hamel.Joint("slider_crank").exceptions == ("b.c = 0",)


def test_texts_paths_and_names_are_the_same_joint(ball):
    for given in (SPECS / "ball.joint", str(SPECS / "ball.joint"), (SPECS / "ball.joint").read_text()):
        assert hamel.Joint(given).source == ball.source
    for wrong in (None, 3, ["a"]):
        with pytest.raises(hamel.ArgumentError, match="spec is"):
            hamel.Joint(wrong)
    with pytest.raises(hamel.FileError, match="cannot read nowhere.joint"):
        hamel.Joint("nowhere.joint")


def test_curves_with_knots_in_a_file_pickle_as_one_text(tmp_path):
    knots = "\n".join(f"{i * 0.5},{np.sin(i * 0.5)}" for i in range(9))
    (tmp_path / "knots.csv").write_text(f"angle_rad,lift_m\n{knots}\n")
    spec = 'hamel = 1;\njoint cam {\n    config q: R1;\n    curve lift(rad): m = quintic natural from "knots.csv" continue linear;\n    H = rot_z(q) * trans_z(lift(q));\n}\n'
    (tmp_path / "cam.joint").write_text(spec)
    joint = hamel.Joint(tmp_path / "cam.joint")
    other = pickle.loads(pickle.dumps(joint))
    q = np.linspace(0.3, 3.0, 7)[:, None]
    assert np.array_equal(other.pose(q), joint.pose(q))


def test_mistakes_have_lines_and_the_text_of_the_program():
    with pytest.raises(hamel.FileError) as caught:
        hamel.Joint(PIN_SLOT.replace("rot_z(theta)", "rot_z(angle)"))
    (mistake,) = caught.value.mistakes
    assert mistake.line == 9 and mistake.column == 43 and "angle" in mistake.message
    assert str(caught.value).startswith("error[E") and "--> text:9:43" in str(caught.value)
    with pytest.raises(hamel.FileError) as caught:
        hamel.Joint("hamel = 1;\njoint bad {\n    config Q: SO3;\n    basis e1, e2, e3 of so3;\n    velocity in parent;\n    H = pose(Q, [0, 0, 0]);\n    X = [2 * I(3); O(3, 3)];\n}\n")
    assert caught.value.mistakes[0].line == 7


def test_s_is_the_identity_at_zero_and_its_derivative_that_of_the_paper(ball):
    rotations = np.stack([ball.home().reshape(3, 3), np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])]).reshape(2, 9)
    at_zero = ball.S(rotations)
    assert at_zero.shape == (2, 3, 3) and np.allclose(ball.S(rotations, np.zeros(3)), at_zero, atol=1e-15)
    slopes = ball.dS(rotations)
    assert slopes.shape == (2, 3, 3, 3)
    step = 1e-5
    for k in range(3):
        phi = np.zeros(3)
        phi[k] = step
        # Central differences: step² / 6 times the third derivative, which is below 1, and rounding 1e-16 / step.
        numbers = (ball.S(rotations, phi) - ball.S(rotations, -phi)) / (2 * step)
        assert np.allclose(numbers, slopes[:, k], atol=1e-9)


def test_values_are_those_of_the_compiled_joint():
    scene = SCENE.split("[[body]]")
    text = "[[body]]".join([scene[0], scene[1]]).replace('"TYPE"', '"ball"')
    robot, joint = hamel.load(text), hamel.Joint("ball")
    q = joint.phi(joint.home(), np.random.default_rng(3).normal(size=(50, 3)))
    # The pose is q itself; frames of the scene add a product with the identity.
    assert np.allclose(joint.pose(q), robot.poses(q)[:, 0], rtol=0, atol=1e-15)
    screw = hamel.Joint("screw")
    angle = np.linspace(-5, 5, 11)[:, None]
    poses = screw.pose(angle, lead=0.2)
    assert np.allclose(poses[:, 2, 3], 0.2 * angle[:, 0] / (2 * np.pi), rtol=0, atol=1e-15)
    assert np.allclose(poses[:, 0, 0], np.cos(angle[:, 0]), rtol=0, atol=1e-15)
    assert np.allclose(screw.X(angle, lead=0.2)[:, :, 0], [0, 0, 1, 0, 0, 0.2 / (2 * np.pi)], atol=1e-15)


def test_bodies_of_a_joint_have_poses():
    joint, sizes = hamel.Joint("slider_crank"), {"crank": 0.3, "rod": 0.9, "offset": 0.1}
    home = joint.home(**sizes)
    q = joint.phi(home, np.array([0.3]), **sizes)
    rod, slider = joint.pose(q, "rod", **sizes), joint.pose(q, "slider", **sizes)
    # Loops close to rounding of their coordinates, which Newton's method leaves.
    assert np.allclose(rod @ [0.9, 0, 0, 1], slider @ [0, 0, 0, 1], atol=1e-14)
    with pytest.raises(hamel.ArgumentError, match="they are crank, rod, slider"):
        joint.pose(q, "wheel", **sizes)


def test_arrays_broadcast_and_wrong_ones_are_told(ball):
    home = ball.home()
    assert ball.phi(home, np.zeros((4, 5, 3))).shape == (4, 5, 9)
    assert ball.phi(home[None, None], np.zeros((5, 3))).shape == (1, 5, 9)
    assert ball.S(np.zeros((0, 9))).shape == (0, 3, 3)
    with pytest.raises(hamel.ArgumentError, match=r"q has shape \(3,\): it must have shape \(\.\.\., 9\)"):
        ball.S(np.zeros(3))
    wrong = np.stack([home, 2 * home])
    with pytest.raises(hamel.ArgumentError, match=r"state \(1,\): q is off the manifold of joint `ball` by") as caught:
        ball.dS(wrong)
    assert caught.value.index == (1,)
    with pytest.raises(hamel.ArgumentError, match="an argument holds inf"):
        ball.phi(home, [np.inf, 0, 0])


def test_parameters_are_asked_for_all_at_once():
    screw = hamel.Joint("screw")
    with pytest.raises(hamel.ArgumentError) as caught:
        screw.S([0.0], pitch=1.0)
    assert str(caught.value) == "joint `screw`: it has no parameter `pitch`; its parameter `lead` (m) is not given"
    with pytest.raises(hamel.ArgumentError, match="parameter `lead` of joint type `screw` is 0: it must be other than 0"):
        screw.S([0.0], lead=0)
    with pytest.raises(hamel.ArgumentError, match="lead is 'a': it must be a number"):
        screw.S([0.0], lead="a")


def test_formulas_as_latex_rust_and_html(ball):
    assert ball.latex("X").startswith("X = ") and r"\begin{" in ball.latex("X")
    assert "S" in ball.latex("S") and r"\partial" in ball.latex("dS")
    with pytest.raises(hamel.ArgumentError, match="it must be one of H, X, X_child, S, dS"):
        ball.latex("M")
    with pytest.raises(hamel.ArgumentError, match="joint `ball` has no formula of it"):
        ball.latex("A")
    assert hamel.Joint("slider_crank").latex("H", "rod") != hamel.Joint("slider_crank").latex("H")
    assert "impl Joint<9, 3, 3, 0> for Ball" in ball.rust()
    page = hamel.Joint(PIN_SLOT)._repr_html_()
    assert page.count("<math") == page.count("</math>") >= 3 and "slot &amp; more" in page


def test_joints_pickle_and_are_shared(ball):
    q = ball.phi(ball.home(), [0.3, -0.2, 0.9])
    for other in (pickle.loads(pickle.dumps(ball)), copy.deepcopy(ball)):
        assert other.source == ball.source and np.array_equal(other.dS(q), ball.dS(q))
    found = []
    threads = [threading.Thread(target=lambda: found.append((ball.claims, ball.latex("S"), ball.S(q)))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert len(found) == 8 and all(one[0] == found[0][0] for one in found)


@pytest.mark.parametrize("name", ["revolute", "ball", "planar"])
def test_robots_have_them_as_those_of_the_library(name):
    joint = own(name, "mine")
    expected, robot = hamel.load(SCENE.replace("TYPE", name)), hamel.load(SCENE.replace("TYPE", "mine"), joints=[joint])
    assert robot.joint("first").type == "mine" and robot.sizes == expected.sizes
    random = np.random.default_rng(5)
    q = robot.configuration(random.uniform(-1, 1, (40, robot.sizes.freedoms)))
    v, tau = random.normal(size=(40, robot.sizes.speeds)), random.normal(size=(40, robot.sizes.freedoms))
    # Rounding of kernels times the condition of the mass matrix, which is below 1e3 here.
    assert np.allclose(robot.forward_dynamics(q, v, tau), expected.forward_dynamics(q, v, tau), rtol=1e-12, atol=1e-12)
    slopes, others = robot.forward_dynamics_derivatives(q, v, tau), expected.forward_dynamics_derivatives(q, v, tau)
    for own_slopes, other in zip(slopes, others):
        assert np.allclose(own_slopes, other, rtol=1e-11, atol=1e-11)
    ends = [hamel.simulate(one, 0.5, method="dop853", tolerance=1e-10).v[-1] for one in (robot, expected)]
    assert np.allclose(*ends, rtol=0, atol=1e-9)
    again = pickle.loads(pickle.dumps(robot))
    assert np.array_equal(again.forward_dynamics(q, v, tau), robot.forward_dynamics(q, v, tau))


def test_joints_of_robots_are_told_where_they_are_wrong(ball):
    with pytest.raises(hamel.ArgumentError, match="joints: a joint type of the name `ball` is already registered"):
        hamel.load(SCENE.replace("TYPE", "ball"), joints=[ball])
    with pytest.raises(hamel.ArgumentError, match=r"joints\[0\] is 'ball': it must be a Joint"):
        hamel.load(SCENE.replace("TYPE", "ball"), joints=["ball"])
    with pytest.raises(hamel.FileError, match="there is no joint type `pin_slot`"):
        hamel.load(SCENE.replace("TYPE", "pin_slot"))
    with pytest.raises(hamel.FileError, match="height"):
        hamel.load(SCENE.replace("TYPE", "pin_slot"), joints=[hamel.Joint(PIN_SLOT)])
    robot = hamel.load(SCENE.replace('type = "TYPE"', 'type = "pin_slot", height = 0.1'), joints=[hamel.Joint(PIN_SLOT)])
    assert robot.forward_dynamics(np.zeros(4), np.zeros(4), np.zeros(4)).shape == (4,)


def test_joints_that_are_too_large_are_derived_and_not_evaluated():
    car = hamel.Joint("car")
    assert car.latex("A") and len(car.claims) > 5
    with pytest.raises(hamel.Error, match="joint `car` has 8 degrees of freedom: one that is interpreted has at most 6"):
        car.home(**{parameter.name: 1.0 for parameter in car.parameters})


def test_the_lines_on_joints_in_the_page_run(tmp_path, monkeypatch):
    (program,) = [block for block in (ROOT / "docs/python.md").read_text().split("```") if block.startswith("python\njoint")]
    (tmp_path / "scene.toml").write_text(SCENE.replace("TYPE", "pin_slot"))
    monkeypatch.chdir(tmp_path)
    names = {"hamel": hamel}
    exec(compile(program.removeprefix("python\n"), "python.md", "exec"), names)
    assert names["robot"].joint("first").type == "pin_slot"
