"""Notebooks as they are committed; `notebooks/run` executes them."""

import ast
import json
import re

import pytest
from conftest import ROOT

FOLDER = ROOT / "python/notebooks"
NAMES = ["identification", "joint", "reachable", "robot", "sweep"]


def test_there_are_no_others():
    assert sorted(path.stem for path in FOLDER.glob("*.ipynb")) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_notebooks_are_committed_without_outputs_and_as_jupyter_writes_them(name):
    text = (FOLDER / f"{name}.ipynb").read_text(encoding="utf-8")
    book = json.loads(text)
    assert text == json.dumps(book, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    assert book["metadata"] == {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    ids = [cell["id"] for cell in book["cells"]]
    assert len(set(ids)) == len(ids) and all(re.fullmatch("[a-z][a-z-]*", own) for own in ids)
    code = [cell for cell in book["cells"] if cell["cell_type"] == "code"]
    assert all(cell["execution_count"] is None and cell["outputs"] == [] for cell in code)
    # A run is a test.
    assert any(isinstance(node, ast.Assert) for cell in code for node in ast.walk(ast.parse("".join(cell["source"]))))


@pytest.mark.parametrize("name", NAMES)
def test_links_of_notebooks_lead_to_files(name):
    book = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    pages = ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "markdown"]
    targets = [target for page in pages for target in re.findall(r"\]\(([^)]*)\)", page)]
    assert targets
    for target in targets:
        file, _, part = target.partition("#")
        page = (FOLDER / file).read_text(encoding="utf-8")
        heads = [re.sub(r"[^\w -]", "", head).strip().lower().replace(" ", "-") for head in re.findall(r"^#+ (.*)$", page, re.MULTILINE)]
        assert not part or part in heads, target
