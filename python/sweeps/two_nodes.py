"""A sweep by Ray on two nodes of this machine, one of which is lost half way: `.venv/bin/python sweeps/two_nodes.py --rows 1000000`.

The double pendulum moves side by side, the arm one by one. Prints motions a second, how many bytes of results are those of a sweep in one process, and the peak memory of the process that asked for the sweep.
"""

import argparse
import json
import os
import pickle
import resource
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import hamel
import numpy as np
import pyarrow
import pyarrow.parquet
import ray
from ray.cluster_utils import Cluster

ROOT = Path(__file__).resolve().parents[2]

# Scenes by name, and between which bounds rows change their numbers.
CASES = {
    "pendulum": (
        ROOT / "tests/data/scenes/double_pendulum.toml",
        {"body.upper.initial.configuration.1": (-1.0, 1.0), "body.lower.initial.configuration.1": (-1.0, 1.0), "body.lower.initial.speeds.1": (-2.0, 2.0)},
    ),
    "arm": (
        ROOT / "scenes/sweep/arm.toml",
        {
            "body.hand.mass": (0.3, 0.9),
            "body.fore.mass": (1.0, 1.4),
            "body.fore.spring.stiffness": (150.0, 210.0),
            "body.upper.initial.configuration.1": (-0.02, 0.02),
            "simulation.t_end": (0.1, 0.15),
        },
    ),
}
FILE_ROWS = 20_000


def rows_of(case, first, count):
    """Rows that depend on their places alone."""
    random = np.random.default_rng(first)
    return {name: random.uniform(*own, count) for name, own in CASES[case][1].items()}


def write_table(folder, case, rows):
    folder.mkdir()
    for first in range(0, rows, FILE_ROWS):
        table = pyarrow.table(rows_of(case, first, min(FILE_ROWS, rows - first)))
        pyarrow.parquet.write_table(table, folder / f"{first:09}.parquet", row_group_size=FILE_ROWS // 4)


def written(folder):
    """Rows of the files that are whole."""
    count = 0
    for path in folder.glob("*.parquet"):
        try:
            count += pyarrow.parquet.read_metadata(path).num_rows
        except (OSError, pyarrow.ArrowInvalid):
            pass
    return count


def peak():
    """Peak memory of this process, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def two_nodes():
    own = {"num_cpus": 1, "object_store_memory": 200 * 2**20}
    cluster = Cluster(initialize_head=True, head_node_args=own)
    second = cluster.add_node(**own)
    ray.init(address=cluster.address, logging_level="ERROR", log_to_driver=False)
    return cluster, second


def sweep(case, table, output, rows, estimate, kill):
    """Moves all rows, without the second node from the middle on; gives how long it took, s, and how many rows were there then."""
    cluster, second = two_nodes()
    thread = threading.Thread(target=hamel.sweep, args=(CASES[case][0], table), kwargs={"engine": "ray", "output": output, "estimate": estimate})
    start, before = time.perf_counter(), peak()
    thread.start()
    there = 0
    while kill and thread.is_alive() and (there := written(output)) < rows // 2:
        time.sleep(0.5)
    lost = time.perf_counter() - start
    if kill:
        cluster.remove_node(second, allow_graceful=False)
    thread.join()
    duration = time.perf_counter() - start
    alive = sum(node["Alive"] for node in ray.nodes())
    ray.shutdown()
    cluster.shutdown()
    print(f"sweep      {rows} rows in {duration:.1f} s, {rows / duration:.0f} motions a second; {alive} of 2 nodes at the end")
    if kill:
        print(f"lost       the second node after {lost:.1f} s, when {there} rows were written: {there / lost:.0f} a second until then, {(rows - there) / (duration - lost):.0f} afterwards")
    print(f"memory     {peak():.0f} MB at most in the process that asked, {before:.0f} MB before the sweep")
    print(f"level      {json.loads((output / 'sweep.json').read_text())['level']}")


def compare(case, output, rows, estimate):
    """Compares the sorted results with those of a process without Ray, a file of the table at a time."""
    program = "import hamel, pickle, sys; a, k = pickle.load(sys.stdin.buffer); pickle.dump(hamel.sweep(*a, **k), sys.stdout.buffer)"
    files = [pyarrow.parquet.read_table(path) for path in output.glob("*.parquet")]
    results = pyarrow.concat_tables(files).sort_by("row")
    assert results["row"].to_pylist() == list(range(1, rows + 1)), "rows are missing, or there twice"
    count = same = 0
    start = time.perf_counter()
    for first in range(0, rows, FILE_ROWS):
        asked = pickle.dumps(((str(CASES[case][0]), rows_of(case, first, min(FILE_ROWS, rows - first))), {"estimate": estimate}))
        done = subprocess.run([sys.executable, "-c", program], input=asked, capture_output=True, check=True)
        expected, found = pickle.loads(done.stdout), results.slice(first, FILE_ROWS)
        for name, values in expected.items():
            own = found[name].to_numpy()
            ours, theirs = (own.astype(str), values) if name == "outcome" else (own.view("u8"), values.view("u8"))
            count += values.nbytes
            same += values.nbytes if name == "outcome" and ours.tolist() == theirs.tolist() else 0
            same += 0 if name == "outcome" else int((ours == theirs).sum()) * 8
    duration = time.perf_counter() - start
    print(f"compared   {count} bytes, of which {count - same} differ; in one process {rows / duration:.0f} motions a second on {os.cpu_count()} cores")
    return count == same


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=100_000)
    parser.add_argument("--scene", choices=CASES, default="pendulum")
    parser.add_argument("--estimate", action="store_true", help="estimate errors, which takes about as long again")
    parser.add_argument("--keep-nodes", action="store_true", help="lose no node")
    parser.add_argument("--no-comparison", action="store_true", help="do not compute the rows again in one process")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        table, output = Path(folder) / "table", Path(folder) / "results"
        write_table(table, given.scene, given.rows)
        sweep(given.scene, table, output, given.rows, given.estimate, not given.keep_nodes)
        is_same = given.no_comparison or compare(given.scene, output, given.rows, given.estimate)
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
