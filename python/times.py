"""Prints what the page `docs/python.md` says of sizes and times. Run it with `.venv/bin/python` after `check`, on a machine that does nothing else."""

import re
import subprocess
import sys
import tempfile
import time
import timeit
from pathlib import Path

import hamel
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PANDA = ROOT / "tests/data/urdf/panda7.urdf"
PENDULUM = ROOT / "tests/data/scenes/pendulum.toml"


def least(call, count=1000, repeat=100):
    """The least of several means, µs."""
    return min(timeit.repeat(call, number=count, repeat=repeat)) / count * 1e6


def measured(call):
    """Time on the wall and time of all cores, s."""
    wall, work = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - wall, time.process_time() - work


def wheel():
    for path in (ROOT / "target/python/wheels").glob("*.whl"):
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB")


def first_minute():
    """From nothing to a page of a moving robot: a virtual environment, the wheel with numpy, the program and the package."""
    (path,) = (ROOT / "target/python/wheels").glob("*.whl")
    script = f"import hamel; hamel.simulate(hamel.load({str(PANDA)!r}), 1.0).save('package.html')"
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-m", "venv", "venv"], cwd=folder, check=True)
        made = time.perf_counter()
        subprocess.run(["venv/bin/pip", "install", "--quiet", "--disable-pip-version-check", path], cwd=folder, check=True)
        installed = time.perf_counter()
        subprocess.run(["venv/bin/hamel", "simulate", PANDA, "--quiet", "--html", "program.html"], cwd=folder, check=True)
        by_program = time.perf_counter()
        subprocess.run(["venv/bin/python", "-c", script], cwd=folder, check=True)
        end = time.perf_counter()
    parts = [made - begin, installed - made, by_program - installed, end - by_program]
    print("an empty environment, pip install, a page by the program, one by the package: " + ", ".join(f"{part:.1f} s" for part in parts))


def imports():
    """Time of `import hamel` after `import numpy`, and of both, in a process of its own, s."""
    program = "import time; a = time.perf_counter(); import numpy; b = time.perf_counter(); import hamel; c = time.perf_counter(); print(c - b, c - a)"
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True) for _ in range(5)]
    own, both = min(tuple(map(float, run.stdout.split())) for run in runs)
    print(f"import hamel: {own:.3f} s, with numpy {both:.3f} s")


def calls():
    """One call of forward dynamics beside that of Rust, which `examples/states.rs` measures."""
    for path in (PENDULUM, PANDA):
        robot = hamel.load(path)
        q, v, tau = (np.full(robot.sizes.speeds, value) for value in (0.7, -0.3, 1.0))
        program = ROOT / "target/python/release/examples/states"
        in_rust = min(float(subprocess.run([program, path, "time"], capture_output=True, check=True).stdout) for _ in range(3))
        ours = least(lambda: robot.forward_dynamics(q, v, tau)) - least(lambda: None)
        print(f"{robot.name}, one state: {ours:.2f} µs, in Rust {in_rust:.2f} µs, more by {ours - in_rust:.2f} µs")


def batches():
    """Forward dynamics of many states of panda7."""
    robot, random = hamel.load(PANDA), np.random.default_rng(1)
    for count in (10**5, 10**6):
        q, v, tau = random.uniform(-2, 2, (count, 7)), random.normal(size=(count, 7)), random.normal(size=(count, 7))
        for threads in (1, 2, None):
            hamel.set_threads(threads)
            wall, work = min(measured(lambda: robot.forward_dynamics(q, v, tau)) for _ in range(3))
            print(f"panda7, {count:.0e} states, {threads or 'all'} threads: {wall:.3f} s, {work / count * 1e6:.2f} µs of one core a state")


def compiled():
    """Compiled equations beside the general algorithms: what compiling takes, one call, and a state of a batch on one core."""
    hamel.set_threads(1)
    for path in (PENDULUM, PANDA):
        robot = hamel.load(path)
        began = time.perf_counter()
        own = robot.compile()
        seconds, size, count = time.perf_counter() - began, robot.sizes.speeds, 10**5
        one = tuple(np.full(size, value) for value in (0.7, -0.3, 1.0))
        many = tuple(np.random.default_rng(1).uniform(-2, 2, (3, count, size)))
        tree, fast = (least(lambda: model.forward_dynamics(*one)) - least(lambda: None) for model in (robot, own))
        trees, fasts = (min(measured(lambda: model.forward_dynamics(*many))[1] for _ in range(5)) / count * 1e6 for model in (robot, own))
        print(f"{robot.name}: compiled in {seconds:.2f} s; one state {fast:.2f} µs, by the tree {tree:.2f} µs; in a batch {fasts:.2f} µs, by the tree {trees:.2f} µs")
    hamel.set_threads(None)


def interpreted():
    """A chain of 7 hinges as panda7 has them, of the library's joint and of the same spec interpreted; and what it takes to derive that."""
    spec = (ROOT / "joint-specs/revolute.joint").read_text().replace("joint revolute", "joint hinge")
    began = time.perf_counter()
    joint = hamel.Joint(spec)
    print(f"deriving a hinge: {time.perf_counter() - began:.3f} s")
    body = """[[body]]
name = "link{0}"
parent = "{1}"
mass = 2.0
com = [0.0, 0.1, 0.1]
inertia = [[0.03, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.01]]
joint = {{ type = "KIND", name = "joint{0}" }}
at = {{ position = [0.0, 0.1, 0.2], axis = [{2}] }}
"""
    axes = ["0.0, 0.0, 1.0", "0.0, 1.0, 0.0"]
    bodies = [body.format(i, f"link{i - 1}" if i else "world", axes[i % 2]) for i in range(7)]
    text = 'hamel = 1\nname = "chain"\ngravity = [0.0, 0.0, -9.81]\n' + "".join(bodies)
    random, count = np.random.default_rng(1), 10**4
    q, v, tau = (random.normal(size=(count, 7)) for _ in range(3))
    hamel.set_threads(1)
    times = []
    for kind, joints in (("revolute", []), ("hinge", [joint])):
        robot = hamel.load(text.replace("KIND", kind), joints=joints)
        forward = min(measured(lambda: robot.forward_dynamics(q, v, tau))[1] for _ in range(5)) / count
        slopes = min(measured(lambda: robot.forward_dynamics_derivatives(q, v, tau))[1] for _ in range(3)) / count
        times.append((forward, slopes))
        print(f"7 hinges, {kind}: forward dynamics {forward * 1e6:.2f} µs, with derivatives {slopes * 1e6:.2f} µs")
    print("interpreted over compiled: " + ", ".join(f"{own / other:.1f}" for own, other in zip(times[1], times[0])))
    hamel.set_threads(None)


def others():
    """The same by Pinocchio in a loop and by one step of MuJoCo's rollout, where they are installed; panda7 without the damping that Pinocchio leaves out."""
    text = re.sub('damping="[^"]*"', 'damping="0"', PANDA.read_text())
    random, count = np.random.default_rng(1), 10**5
    q, v, tau = random.uniform(-2, 2, (count, 7)), random.normal(size=(count, 7)), random.normal(size=(count, 7))
    robot = hamel.load(text)
    expected = robot.forward_dynamics(q, v, tau)

    def tell(name, call, accelerations):
        wall, work = min(measured(call) for _ in range(3))
        difference = np.abs(accelerations(call()) - expected).max() / np.abs(expected).max()
        print(f"{name}: {work / count * 1e6:.2f} µs of one core a state, {difference:.0e} apart")

    tell("hamel", lambda: robot.forward_dynamics(q, v, tau), lambda rates: rates)
    try:
        import pinocchio
    except ImportError:
        print("no pinocchio: pip install pin")
    else:
        model = pinocchio.buildModelFromXML(text)
        data = model.createData()
        tell(
            f"pinocchio {pinocchio.__version__} in a loop",
            lambda: [pinocchio.aba(model, data, *state).copy() for state in zip(q, v, tau)],
            np.array,
        )
    try:
        import mujoco
        from mujoco import rollout
    except ImportError:
        print("no mujoco: pip install mujoco")
    else:
        model = mujoco.MjSpec.from_string(text).compile()
        off = mujoco.mjtDisableBit
        model.opt.disableflags |= int(off.mjDSBL_CONTACT) | int(off.mjDSBL_CONSTRAINT)
        model.opt.timestep = 1e-7
        start = np.hstack([np.zeros((count, 1)), q, v])
        efforts, spec = tau[:, None], int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
        data = mujoco.MjData(model)
        tell(
            f"mujoco {mujoco.__version__}, a step of rollout",
            lambda: rollout.rollout(model, data, start, efforts, control_spec=spec, nstep=1)[0],
            lambda states: (states[:, 0, 8:] - v) / model.opt.timestep,
        )


wheel()
first_minute()
imports()
calls()
batches()
compiled()
others()
interpreted()
