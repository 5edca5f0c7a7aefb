"""Sweeps on clusters of this machine, beside those of one process."""

import contextlib
import json
import os
import pickle
import subprocess
import sys
import threading
import time

import hamel
import numpy as np
import pytest
from conftest import PENDULUM, SCENES, pendulums

ray = pytest.importorskip("ray", reason="the sweeps by Ray need it: pip install 'ray[data]>=2.60'")
pytest.importorskip("ray.data")
arrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

# Ray leaves files and threads to its processes, and warns of what it is to change.
pytestmark = pytest.mark.filterwarnings("default")

ARM = SCENES / "sweep/arm.toml"
MASS = "body.hand.mass"
LOWEST = "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable"


def table(count):
    random = np.random.default_rng(5)
    rows = {MASS: random.uniform(0.3, 0.9, count), "body.upper.initial.configuration.1": random.normal(0.0, 0.01, count)}
    rows[MASS][count // 3] = -1.0
    return rows


def in_files(folder, rows, files=3, group=40):
    """The rows in files of several groups."""
    folder.mkdir()
    whole = arrow.table(rows)
    size = -(-len(whole) // files)
    for place in range(files):
        parquet.write_table(whole.slice(place * size, size), folder / f"{place}.parquet", row_group_size=group)
    return folder


def sorted_results(folder):
    """What a sweep has written, by rows."""
    whole = arrow.concat_tables([parquet.read_table(path) for path in folder.glob("*.parquet")]).sort_by("row")
    found = {name: whole[name].to_numpy() for name in whole.column_names}
    assert np.array_equal(found.pop("row"), np.arange(1, len(whole) + 1))
    return {**found, "outcome": found["outcome"].astype(str)}


def assert_same_bytes(found, expected):
    assert list(found) == list(expected)
    for name, values in expected.items():
        assert found[name].tobytes() == values.tobytes(), name


@contextlib.contextmanager
def nodes(**second):
    """A cluster of two nodes with one core each, and the second of them."""
    from ray.cluster_utils import Cluster

    store = {"num_cpus": 1, "object_store_memory": 100 * 2**20}
    cluster = Cluster(initialize_head=True, head_node_args=store)
    try:
        other = cluster.add_node(**store, **second)
        ray.init(address=cluster.address, logging_level="ERROR", log_to_driver=False)
        yield cluster, other
    finally:
        ray.shutdown()
        cluster.shutdown()


@pytest.fixture(scope="module")
def two_nodes():
    with nodes() as both:
        yield both


def test_files_give_the_bytes_of_one_process(two_nodes, tmp_path):
    rows = table(300)
    folder = in_files(tmp_path / "table", rows)
    expected = hamel.sweep(ARM, rows)
    assert_same_bytes(hamel.sweep(ARM, folder, engine="ray"), expected)
    files = sorted(folder.iterdir())
    assert hamel.sweep(hamel.load(ARM), files, 1, engine="ray", output=tmp_path / "out") is None
    assert_same_bytes(sorted_results(tmp_path / "out"), expected)
    told = json.loads((tmp_path / "out/sweep.json").read_text())
    assert told["is_complete"] is True
    assert (told["version"], told["rows"], told["columns"]) == (hamel.__version__, 300, list(rows))
    assert told["scene"] == {"name": str(ARM), "text": ARM.read_text()}
    assert told["level"] in ("x86-64", "x86-64-v3") or sys.platform != "linux"


def test_tables_in_memory_and_datasets_are_rows_in_their_order(two_nodes):
    rows = table(50)
    expected = hamel.sweep(ARM, rows, estimate=False)
    dataset = ray.data.from_arrow([arrow.table(rows).slice(start, 9) for start in range(0, 50, 9)])
    for given in (rows, arrow.table(rows), dataset):
        assert_same_bytes(hamel.sweep(ARM, given, engine="ray", estimate=False), expected)


def test_rows_go_side_by_side_with_the_bytes_of_one_process(two_nodes, tmp_path):
    rows = pendulums(700)
    expected = hamel.sweep(PENDULUM, rows, estimate=False)
    tree = hamel.sweep(PENDULUM, rows, estimate=False, equations="tree")
    assert any(expected[name].tobytes() != tree[name].tobytes() for name in expected)
    dataset = ray.data.from_arrow([arrow.table(rows).slice(start, 90) for start in range(0, 700, 90)])
    for given in (rows, in_files(tmp_path / "table", rows), dataset):
        assert_same_bytes(hamel.sweep(PENDULUM, given, engine="ray", estimate=False), expected)
    for equations, why in (("auto", None), ("tree", "that was asked for")):
        out = tmp_path / equations
        hamel.sweep(PENDULUM, tmp_path / "table", engine="ray", estimate=False, equations=equations, output=out)
        assert_same_bytes(sorted_results(out), expected if why is None else tree)
        told = json.loads((out / "sweep.json").read_text())
        assert (told["equations"], told["why_tree"]) == (equations, why)


def test_no_rows_have_no_results(two_nodes):
    found = hamel.sweep(ARM, {MASS: []}, engine="ray", estimate=False)
    assert_same_bytes(found, hamel.sweep(ARM, {MASS: []}, estimate=False))


def test_wrong_columns_are_told_before_anything_moves(two_nodes, tmp_path):
    wrong = in_files(tmp_path / "wrong", {"body.hand.mas": [1.0]}, files=1)
    with pytest.raises(hamel.ArgumentError, match="column `body.hand.mas`: in `body.hand`: the scene has no `mas` there; did you mean `mass`?"):
        hamel.sweep(ARM, wrong, engine="ray", output=tmp_path / "out")
    assert not (tmp_path / "out").exists()
    texts = in_files(tmp_path / "texts", {MASS: ["a"]}, files=1)
    with pytest.raises(hamel.ArgumentError, match="column `body.hand.mass` holds string, and must hold numbers"):
        hamel.sweep(ARM, texts, engine="ray")
    parquet.write_table(arrow.table({"gravity.2": [1.0]}), wrong / "1.parquet")
    with pytest.raises(hamel.ArgumentError, match=r"1.parquet has the columns \['gravity.2'\], and the files before it \['body.hand.mas'\]"):
        hamel.sweep(ARM, wrong, engine="ray")


def test_files_that_are_none_are_told(two_nodes, tmp_path):
    with pytest.raises(hamel.FileError, match="absent.parquet: it is not there"):
        hamel.sweep(ARM, tmp_path / "absent.parquet", engine="ray")
    (tmp_path / "text.parquet").write_text("a,b")
    with pytest.raises(hamel.FileError, match="cannot read .*text.parquet: "):
        hamel.sweep(ARM, tmp_path / "text.parquet", engine="ray")
    (tmp_path / "empty").mkdir()
    with pytest.raises(hamel.FileError, match="it holds no files that end in .parquet or .pq"):
        hamel.sweep(ARM, tmp_path / "empty", engine="ray")


def test_a_folder_that_holds_files_stays_as_it_is(two_nodes, tmp_path):
    (tmp_path / "note").write_text("own")
    with pytest.raises(hamel.ArgumentError, match="which holds files: name a folder of its own for the results"):
        hamel.sweep(ARM, table(3), engine="ray", output=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["note"]


def at_the_lowest_level(rows):
    """The results of a process without fused products."""
    program = "import hamel, pickle, sys; pickle.dump(hamel.sweep(*pickle.load(sys.stdin.buffer), level='x86-64'), sys.stdout.buffer)"
    environment = {**os.environ, "GLIBC_TUNABLES": LOWEST}
    done = subprocess.run([sys.executable, "-c", program], input=pickle.dumps((str(ARM), rows)), capture_output=True, env=environment, timeout=300)
    assert done.returncode == 0, done.stderr.decode()
    return pickle.loads(done.stdout)


@pytest.mark.skipif(hamel._hamel.arithmetic()[0] != "x86-64-v3", reason="this processor has one level of instructions")
def test_the_level_is_the_lowest_of_the_nodes(tmp_path):
    rows = table(200)
    own, expected = hamel.sweep(ARM, rows), at_the_lowest_level(rows)
    assert any(own[name].tobytes() != expected[name].tobytes() for name in own), "the level makes no difference"
    ray.shutdown()
    with nodes(env_vars={"GLIBC_TUNABLES": LOWEST}):
        hamel.sweep(ARM, rows, engine="ray", output=tmp_path / "out")
        with pytest.raises(hamel.ArgumentError, match="level is 'x86-64-v3', and not all nodes have it: .* has hamel .* at x86-64 "):
            hamel.sweep(ARM, rows, engine="ray", level="x86-64-v3")
    assert_same_bytes(sorted_results(tmp_path / "out"), expected)
    assert json.loads((tmp_path / "out/sweep.json").read_text())["level"] == "x86-64"


def written(folder):
    """Rows of the files that are whole."""
    count = 0
    for path in folder.glob("*.parquet"):
        with contextlib.suppress(OSError, arrow.ArrowInvalid):
            count += parquet.read_metadata(path).num_rows
    return count


def test_a_node_that_is_lost_half_way_loses_nothing(tmp_path):
    count = 12800
    rows = {**table(count), "simulation.t_end": np.linspace(0.1, 0.2, count)}
    folder, out = in_files(tmp_path / "table", rows, group=1000), tmp_path / "out"
    ray.shutdown()
    with nodes() as (cluster, other):
        sweep = threading.Thread(target=hamel.sweep, args=(ARM, folder), kwargs={"engine": "ray", "output": out})
        sweep.start()
        deadline = time.monotonic() + 300
        # No core is free: there is an actor on each node.
        while written(out) < count // 4 or ray.available_resources().get("CPU", 0) > 0:
            assert sweep.is_alive() and time.monotonic() < deadline
            time.sleep(0.1)
        done = written(out)
        cluster.remove_node(other, allow_graceful=False)
        assert sweep.is_alive()
        assert count // 4 <= done < count * 3 // 4
        sweep.join(timeout=600)
        assert not sweep.is_alive()
        assert sum(node["Alive"] for node in ray.nodes()) == 1
    assert json.loads((out / "sweep.json").read_text())["is_complete"] is True
    assert_same_bytes(sorted_results(out), hamel.sweep(ARM, rows))
