"""The program that the wheel installs."""

import csv
import subprocess
import sys
from pathlib import Path

import hamel
import numpy as np
from test_motion import PENDULUM

PROGRAM = Path(sys.executable).with_name("hamel")


def run(*arguments, program=(PROGRAM,)):
    return subprocess.run([*program, *arguments], capture_output=True, text=True, timeout=120)


def test_both_ways_to_start_it_answer():
    told = run("--version")
    assert (told.returncode, told.stdout) == (0, f"hamel {hamel.__version__}\n")
    assert run("--version", program=(sys.executable, "-m", "hamel")).stdout == told.stdout
    wrong = run("simulate")
    assert wrong.returncode == 2 and "Usage: hamel simulate" in wrong.stderr
    missing = run("simulate", "missing.toml")
    assert missing.returncode == 1 and "missing.toml" in missing.stderr


def test_its_motions_are_those_of_the_package(tmp_path):
    (tmp_path / "pendulum.toml").write_text(PENDULUM)
    files = {ending: tmp_path / f"motion.{ending}" for ending in ("csv", "parquet", "html")}
    options = [text for ending, path in files.items() for text in (f"--{ending}", path)]
    done = run("simulate", tmp_path / "pendulum.toml", "--t-end", "2", "--sample-step", "0.5", *options)
    assert done.returncode == 0, done.stderr
    with files["csv"].open() as file:
        rows = list(csv.DictReader(file))
    motion = hamel.simulate(hamel.load(PENDULUM), 2.0, sample_step=0.5)
    assert [float(row["hinge.q.q_rad"]) for row in rows] == motion.q[:, 0].tolist()
    assert np.array_equal([float(row["hinge.v.q_rad_per_s"]) for row in rows], motion.v[:, 0])
    assert all(path.stat().st_size > 100 for path in files.values())
