"""A sweep of double pendulums beside MuJoCo's `rollout`: `.venv/bin/python sweeps/beside_mujoco.py`, after `.venv/bin/pip install mujoco`.

Both take 1000 steps of the classical Runge-Kutta method, in doubles, on as many threads. Rounds alternate; printed are medians of motions a second, and how far the ends are apart. A rollout also writes down each state, as it always does.
"""

import argparse
import os
import statistics
import time
from pathlib import Path

import hamel
import mujoco
import numpy as np
from mujoco import rollout

SCENE = Path(__file__).resolve().parents[2] / "tests/data/scenes/double_pendulum.toml"
STEPS = 1000
# The same links; what they do not have is switched off.
MODEL = """
<mujoco>
  <option timestep="0.001" integrator="RK4" gravity="0 0 -9.81"><flag contact="disable" constraint="disable" limit="disable"/></option>
  <worldbody>
    <body name="upper"><joint axis="0 1 0"/><inertial pos="0.2 0 0" mass="1" diaginertia="0.008 0.01 0.009"/>
      <body name="lower" pos="0.45 0 0"><joint axis="0 1 0"/><inertial pos="0.2 0 0" mass="1" diaginertia="0.008 0.01 0.009"/></body>
    </body>
  </worldbody>
</mujoco>
"""


def by_hamel(q, v, workers, equations):
    table = {}
    for index, name in enumerate(("upper", "lower")):
        table[f"body.{name}.initial.configuration.1"] = q[:, index]
        table[f"body.{name}.initial.speeds.1"] = v[:, index]
    found = hamel.sweep(SCENE, table, workers, estimate=False, equations=equations)
    assert np.all(found["outcome"] == "ended") and np.all(found["steps"] == STEPS)
    return np.stack([found["upper.q.q_rad"], found["lower.q.q_rad"]], axis=-1)


def by_mujoco(model, data, q, v):
    states, _ = rollout.rollout(model, data, np.hstack([np.zeros((len(q), 1)), q, v]), nstep=STEPS)
    return states[:, -1, 1:3]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=2000, help="motions of MuJoCo and of the tree in a round; side by side it is ten times as many")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    given = parser.parse_args()
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = [mujoco.MjData(model) for _ in range(given.workers)]
    random = np.random.default_rng(1)
    q, v = random.uniform(-1.0, 1.0, (2, 10 * given.rows, 2))
    ways = {
        "hamel, side by side": (10 * given.rows, lambda q, v: by_hamel(q, v, given.workers, "lanes")),
        "hamel, by the tree": (given.rows, lambda q, v: by_hamel(q, v, given.workers, "tree")),
        "MuJoCo rollout": (given.rows, lambda q, v: by_mujoco(model, data, q, v)),
    }
    times, ends = {name: [] for name in ways}, {}
    for _ in range(given.rounds):
        for name, (rows, way) in ways.items():
            start = time.perf_counter()
            ends[name] = way(q[:rows], v[:rows])[: given.rows]
            times[name].append(rows / (time.perf_counter() - start))
    print(f"MuJoCo {mujoco.__version__}, {given.workers} threads, {STEPS} steps")
    for name, rates in times.items():
        apart = np.abs(ends[name] - ends["MuJoCo rollout"]).max()
        print(f"{name:20} {statistics.median(rates):10.0f} motions a second; at the end {apart:.0e} rad off MuJoCo at most")


if __name__ == "__main__":
    main()
