"""Executes notebooks in the interpreter that runs this: `execute.py FOLDER [NOTEBOOK …]`, all of them without names. Executed copies, whole or up to the cell that fails, are left in the folder."""

import re
import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError
from traitlets.config import Config

HERE = Path(__file__).resolve().parent
# s for a cell; all cells of a notebook take some seconds.
TIMEOUT = 300
COLORS = re.compile(r"\x1b\[[0-9;]*m")


def executed(notebook):
    """Why a notebook fails, or None."""
    begun = []
    client = NotebookClient(
        notebook,
        timeout=TIMEOUT,
        kernel_name="python3",
        resources={"metadata": {"path": HERE}},
        # Nothing outside this machine can listen.
        config=Config(KernelManager={"transport": "ipc"}),
        on_cell_start=lambda cell, cell_index: begun.append(cell.id),
    )
    try:
        client.execute()
    except (CellExecutionError, CellTimeoutError, DeadKernelError) as error:
        cell = begun[-1] if begun else "none"
        return f"cell `{cell}`:\n{COLORS.sub('', str(error)).strip()}"
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            # Warnings, which users would see.
            if output.get("name") == "stderr":
                return f"cell `{cell.id}` writes to stderr:\n{output.text.strip()}"
    return None


def main(folder, names):
    paths = [HERE / name for name in names] or sorted(HERE.glob("*.ipynb"))
    is_right = True
    for path in paths:
        notebook = nbformat.read(path, as_version=4)
        begin = time.perf_counter()
        failure = executed(notebook)
        folder.mkdir(parents=True, exist_ok=True)
        nbformat.write(notebook, folder / path.name)
        print(f"{path.name}: {time.perf_counter() - begin:.1f} s", flush=True)
        if failure is not None:
            is_right = False
            print(f"{path.name}, {failure}", file=sys.stderr, flush=True)
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
