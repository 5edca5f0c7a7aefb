"""What users see: names, types and docstrings."""

import inspect
import subprocess
import sys

import hamel
import pytest
from conftest import ROOT


def test_all_that_is_offered_is_told():
    for name in hamel.__all__:
        own = getattr(hamel, name)
        assert inspect.getdoc(own), name
    members = (member for member in dir(hamel.Robot) if not member.startswith("_"))
    for member in members:
        assert inspect.getdoc(getattr(hamel.Robot, member)), member


@pytest.mark.parametrize("name", [name for name in dir(hamel.Robot) if not name.startswith("_") and callable(getattr(hamel.Robot, name))])
def test_methods_tell_all_of_their_arguments(name):
    method = getattr(hamel.Robot, name)
    text = inspect.getdoc(method)
    arguments = list(inspect.signature(method).parameters)[1:]
    if name not in ("joint", "state"):
        assert all(f"    {argument}: " in text for argument in arguments), text


@pytest.mark.parametrize(
    "command",
    [
        ["mypy", "--strict", "--config-file", "{root}/python/pyproject.toml", "--cache-dir", "{cache}", "-p", "hamel"],
        ["mypy.stubtest", "hamel", "--mypy-config-file", "{root}/python/pyproject.toml", "--allowlist", "{root}/python/tests/not_imported.txt", "--ignore-unused-allowlist"],
    ],
    ids=["types", "stubs"],
)
def test_types_hold(command, tmp_path):
    pytest.importorskip("mypy")
    command = [part.format(cache=tmp_path, root=ROOT) for part in command]
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_lines_of_use_in_the_pages_run(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    text = (ROOT / "python/README.md").read_text()
    program = text.split("```python\n")[1].split("```")[0]
    more = [part.split("```")[0] for part in (ROOT / "docs/python.md").read_text().split("```python\n")[1:4]]
    (tmp_path / "panda.urdf").write_text((ROOT / "tests/data/urdf/panda7.urdf").read_text())
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(program, "README.md", "exec"), names)
    names["q"] = names["q"][0]
    exec(compile("\n".join(more), "python.md", "exec"), names)
