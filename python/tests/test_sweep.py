"""Many motions of one scene, beside single ones and the program's."""

import csv
import os
import pickle
import subprocess
import sys
from pathlib import Path

import hamel
import numpy as np
import pytest
from conftest import PENDULUM, SCENES, pendulums

ARM = SCENES / "sweep/arm.toml"
MASS = "body.hand.mass"


def table(count):
    random = np.random.default_rng(3)
    return {MASS: random.uniform(0.3, 0.9, count), "body.upper.initial.configuration.1": random.normal(0.0, 0.01, count)}


def test_rows_are_the_motions_of_their_scenes():
    rows = table(5)
    found = hamel.sweep(ARM, rows)
    assert list(found)[:3] == ["outcome", "t_s", "energy_J"]
    text = ARM.read_text()
    for row in range(5):
        own = text.replace("mass = 0.6", f"mass = {rows[MASS][row]!r}".replace("np.float64(", "").replace(")", ""))
        first = float(rows["body.upper.initial.configuration.1"][row])
        own = own.replace("configuration = [0.0]", f"configuration = [{first!r}]", 1)
        motion = hamel.simulate(hamel.load(own), samples=[], t_end=1.0) if found["outcome"][row] == "ended" else None
        if motion is not None:
            assert found["steps"][row] == motion.statistics["steps"]
            assert found["error"][row] == motion.end_error
    assert (found["outcome"] == "ended").any()


def test_bits_do_not_depend_on_workers_and_on_the_kind_of_table():
    pandas = pytest.importorskip("pandas")
    rows = table(40)
    found = hamel.sweep(hamel.load(ARM), rows, 1, estimate=False)
    for other in (hamel.sweep(ARM, rows, 4, estimate=False), hamel.sweep(ARM, pandas.DataFrame(rows), estimate=False)):
        assert list(other) == list(found)
        for name, values in found.items():
            assert np.array_equal(values, other[name], equal_nan=name != "outcome"), name
    assert "error" not in found


def test_samples_are_told_by_their_times():
    rows = table(3)
    found = hamel.sweep(ARM, rows, estimate=False, at=[0.0, 0.25])
    assert np.array_equal(found["shoulder.q.q_rad@0"], rows["body.upper.initial.configuration.1"])
    whole = hamel.sweep(ARM, rows, estimate=False, at=np.array([0.25]))
    assert np.array_equal(whole["elbow.v.q_rad_per_s@0.25"], found["elbow.v.q_rad_per_s@0.25"])
    assert pickle.loads(pickle.dumps(hamel._hamel.Sweep(hamel._hamel.scene_text(ARM, False), [MASS], (False, "tree", [0.25]), []))).results[-1].endswith("@0.25")
    with pytest.raises(hamel.ArgumentError, match="a sample at 0.1 s comes after one at 0.2 s"):
        hamel.sweep(ARM, rows, at=[0.2, 0.1])
    with pytest.raises(hamel.ArgumentError, match="at is no array of numbers"):
        hamel.sweep(ARM, rows, at="soon")


def test_rows_fail_alone():
    found = hamel.sweep(ARM, {MASS: [0.5, -1.0, np.nan]}, estimate=False)
    assert found["outcome"].tolist() == [
        "ended",
        "failed: body `hand`: mass is -1 kg: it must be at least 0 (column `body.hand.mass`)",
        "failed: body `hand`: `mass` is nan, not a finite number (column `body.hand.mass`)",
    ]
    assert np.isnan(found["t_s"]).tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ({"body.hand.mas": [1.0]}, "column `body.hand.mas`: in `body.hand`: the scene has no `mas` there; did you mean `mass`?"),
        ({MASS: ["1"]}, "column `body.hand.mass` is no array of numbers: its values are of type <U1"),
        ({MASS: np.array([1, 2], "m8[s]")}, "column `body.hand.mass` is no array of numbers: its values are of type timedelta64[s]"),
        ({MASS: [1.0 + 2.0j]}, "column `body.hand.mass` is no array of numbers: its values are of type complex128"),
        ({MASS: np.array([1.0, "2"], object)}, "column `body.hand.mass` is no array of numbers: '2' is of type str"),
        ({MASS: np.ma.array([1.0, 2.0], mask=[False, True])}, "column `body.hand.mass` has masked values: fill them, or leave the rows out"),
        ({MASS: [1.0], Path(MASS): [2.0]}, "table has two columns `body.hand.mass`"),
        ({MASS: [[1.0]]}, "column `body.hand.mass` has shape (1, 1): it must have shape (n,)"),
        ({MASS: [1.0], "gravity.2": [1.0, 2.0]}, "table has columns of different lengths: {'body.hand.mass': 1, 'gravity.2': 2}"),
        ({}, "table has no columns"),
        (7, "table is 7: it must be a dict of arrays or a data frame"),
    ],
)
def test_tables_that_are_none_are_refused(rows, message):
    with pytest.raises(hamel.ArgumentError) as raised:
        hamel.sweep(ARM, rows)
    assert str(raised.value) == message


def test_workers_are_counted():
    for count in (0, 10**30, 1.5, True):
        with pytest.raises(hamel.ArgumentError, match=r"workers is .*: it must be a whole number from 1 to 65536"):
            hamel.sweep(ARM, table(1), count)
    assert hamel.sweep(ARM, table(1), np.int64(2), estimate=False)["outcome"].tolist() == ["ended"]


def test_sweeps_pickle_as_their_scenes():
    for scene, column in ((ARM, MASS), (PENDULUM, "body.lower.mass")):
        sweep = hamel._hamel.Sweep(hamel._hamel.scene_text(scene, False), [column], (False, "auto", []), [[0.5], [0.7]])
        assert (sweep.why_tree is None) == (scene == PENDULUM), sweep.why_tree
        again = pickle.loads(pickle.dumps(sweep))
        rows = [np.array([0.5, 0.7])]
        for name, values in sweep.rows(rows, 1).items():
            assert np.array_equal(values, again.rows(rows, 1)[name])


@pytest.mark.parametrize("equations", ["auto", "lanes", "tree"])
def test_bits_are_those_of_the_program_with_the_same_equations(equations, tmp_path):
    rows = pendulums(150)
    found = hamel.sweep(PENDULUM, rows, estimate=False, equations=equations)
    text = [",".join(rows), *(",".join(repr(float(values[row])) for values in rows.values()) for row in range(150))]
    (tmp_path / "table.csv").write_text("\n".join(text) + "\n")
    options = [PENDULUM, "--over", tmp_path / "table.csv", "-o", tmp_path / "out", "--no-error-estimate", "--equations", equations]
    subprocess.run([sys.executable, "-m", "hamel", "sweep", *options], check=True, capture_output=True, timeout=300)
    parts = sorted((tmp_path / "out").glob("part-*.csv"))
    told = [row for part in parts for row in csv.DictReader(part.read_text().splitlines())]
    assert [row["outcome"] for row in told] == found["outcome"].tolist()
    for name, values in found.items():
        assert name == "outcome" or np.array_equal([float(row[name]) for row in told], values, equal_nan=True), name
    assert found["outcome"][50].startswith("failed: body `lower`: mass is -1 kg")


def test_side_by_side_differs_from_the_tree_by_rounding():
    rows = pendulums(200)
    lanes, tree = (hamel.sweep(PENDULUM, rows, estimate=False, equations=own) for own in ("auto", "tree"))
    assert lanes["outcome"].tolist() == tree["outcome"].tolist()
    names = [name for name in lanes if name != "outcome"]
    # The bound that the program's own sweeps are tested with.
    for name in names:
        own, other = lanes[name], tree[name]
        assert np.array_equal(np.isnan(own), np.isnan(other)), name
        assert np.nanmax(np.abs(own - other) / np.maximum(1.0, np.abs(other))) < 1e-11, name
    assert any(lanes[name].tobytes() != tree[name].tobytes() for name in names), "all rows have gone by the tree"


def test_rows_that_cannot_go_side_by_side_are_told():
    for scene, options, why in (
        (PENDULUM, {}, "errors of motions are estimated"),
        (ARM, {"estimate": False}, "its method controls the length of steps"),
    ):
        with pytest.raises(hamel.ArgumentError) as raised:
            hamel.sweep(scene, {"gravity.3": [-9.0, -9.5]}, equations="lanes", **options)
        assert str(raised.value) == f"no row can move by equations='lanes': {why}"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"equations": "lane"}, "equations is 'lane': it must be 'auto', 'lanes' or 'tree'"),
        ({"equations": None}, "equations is 'None': it must be 'auto', 'lanes' or 'tree'"),
        ({"engine": "dask"}, "engine is 'dask': it must be None or 'ray'"),
        ({"output": "results"}, "output is for engine='ray': without it results are returned"),
        ({"level": "x86-64-v9"}, "level is 'x86-64-v9': it must be one of x86-64, x86-64-v3"),
    ],
)
def test_options_that_are_none_are_refused(options, message):
    with pytest.raises(hamel.ArgumentError) as raised:
        hamel.sweep(ARM, table(1), **options)
    assert str(raised.value) == message


def test_a_missing_ray_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(hamel.Error, match=r"engine is 'ray', and Ray is not installed \(.*\): pip install 'ray\[data\]>=2.60'"):
        hamel.sweep(ARM, table(1), engine="ray")


@pytest.mark.skipif(hamel._hamel.arithmetic()[0] != "x86-64-v3", reason="this processor has one level of instructions")
def test_a_process_has_one_level():
    with pytest.raises(hamel.ArgumentError, match="level is 'x86-64', and this process computes at 'x86-64-v3': start Python with GLIBC_TUNABLES=") as raised:
        hamel.sweep(ARM, table(1), level="x86-64")
    name, value = str(raised.value).split(" with ")[1].split(" ")[0].split("=", 1)
    program = "import hamel; print(*hamel._hamel.arithmetic())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, name: value}, timeout=60)
    level, sum_of_functions = done.stdout.split()
    assert level == "x86-64" and sum_of_functions != hamel._hamel.arithmetic()[1], done.stderr
