"""The package: stubs, documentation, notebooks, import time, the workflow of releases."""

import doctest
import inspect
import os
import subprocess
import sys

import hc
import numpy as np
import pytest
import tdoa
from conftest import ROOT

FOLDER = ROOT / "crates/python"


def test_stubs_agree_with_what_is_there():
    command = [sys.executable, "-m", "mypy.stubtest", "--mypy-config-file", str(FOLDER / "pyproject.toml"), "hc", "tdoa"]
    output = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert output.returncode == 0, output.stdout + output.stderr


# Each line after `# wrong` is an error to mypy, no other line is.
TYPES = """
import hc
import numpy as np
import sympy
import tdoa

x = sympy.Symbol("x")
hc.solve("x^2 - 1", start="total_degree")
hc.solve(["x^2 - 1", x**2 - 1], variables=[x])
points: np.ndarray = hc.solve("x - 1").real_points
number: int = hc.solve("x - 1").n_real
table = tdoa.simulate(layout="grid", fault=("move", 0.1)).pseudoranges
tdoa.calibrate(table, receiver_delays="auto", dimensions=2)
test: dict[str, float | None] | None = tdoa.calibrate(table, dimensions=3, anchors={"r1": (0, 0, 2.5)}).dimension_test
tdoa.calibrate([[1.0, None], [2.0, 3.0]])
tdoa.calibrate(tdoa.read("table.csv", units="ms", speed=343.0))
with open("table.csv") as file:
    tdoa.read(file)
dimensions: int = tdoa.solve(table, dimensions=3).dimensions
# wrong
hc.solve("x^2 - 1", start="foo")
# wrong
hc.solve(3)
# wrong
hc.solve("x - 1").real
# wrong
tdoa.calibrate("table.csv")
# wrong
tdoa.calibrate(table, errors="late")
# wrong
tdoa.calibrate(table, receiver_delays="some")
# wrong
tdoa.calibrate(table, dimensions=4)
# wrong
tdoa.solve(table, dimensions="space")
# wrong
tdoa.solve(table, start="auto")
# wrong
tdoa.simulate(layout="hall")
# wrong
tdoa.simulate(fault=("loss", 1.0))
# wrong
tdoa.read("table.csv", units="parsec")
"""


def test_mypy_finds_wrong_words(tmp_path):
    (tmp_path / "uses.py").write_text(TYPES)
    (tmp_path / "mypy.ini").write_text("[mypy]\n[mypy-sympy.*]\nignore_missing_imports = True\nfollow_imports = skip\n")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "mypy.ini", "--no-error-summary", "uses.py"]
    output = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    found = [int(line.split(":")[1]) for line in output.stdout.splitlines() if ": error:" in line]
    wrong = [k + 2 for k, line in enumerate(TYPES.splitlines()) if line == "# wrong"]
    assert found == wrong, output.stdout + output.stderr


def test_versions():
    import importlib.metadata

    assert hc.__version__ == tdoa.__version__ == importlib.metadata.version("tdoa")


@pytest.mark.parametrize("thing", [hc.solve, hc.decompose, hc.mixed_volume, hc.certify, hc.Family, tdoa.calibrate, tdoa.solve])
def test_examples_of_the_documentation(thing):
    tests = doctest.DocTestFinder(recurse=False).find(thing, thing.__name__, module=False, globs={})
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    assert sum(len(test.examples) for test in tests) > 0
    assert sum(runner.run(test).failed for test in tests) == 0


def test_all_that_is_public_is_documented():
    for module in (hc, tdoa):
        for name in module.__all__:
            thing = getattr(module, name)
            assert inspect.getdoc(thing), name
            assert thing.__module__ in ("hc", "tdoa"), name
            if inspect.isfunction(thing):
                text = inspect.getdoc(thing)
                assert "Parameters\n----------" in text and "Returns\n-------" in text, name
                for parameter in inspect.signature(thing).parameters:
                    assert parameter in text, f"{name}: {parameter}"
    text = subprocess.run([sys.executable, "-c", "import tdoa; help(tdoa.calibrate)"], capture_output=True, text=True).stdout
    assert "in module tdoa" in text and "shape (m, n)" in text and "metres" in text


def test_nothing_heavy_is_imported():
    code = "import sys, hc, tdoa; print([m for m in ('matplotlib', 'pandas', 'sympy', 'tqdm', 'scipy') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


@pytest.mark.parametrize("name", ["calibrate.ipynb", "minimal_problem.ipynb"])
def test_notebooks(name, tmp_path):
    import nbclient
    import nbformat

    notebook = nbformat.read(FOLDER / "notebooks" / name, as_version=4)
    nbformat.validate(notebook)
    # What is committed has no results that could be stale.
    assert all(not cell.outputs and cell.execution_count is None for cell in notebook.cells if cell.cell_type == "code")
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    texts = [str(output) for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert not any("'output_type': 'error'" in text for text in texts)
    assert any("image/png" in text for text in texts), "a plot is shown"
    # What a reader sees of a line begins after its last return; a busy machine shows a bar for a while.
    streams = ["".join(each.text for each in cell.get("outputs", []) if each.output_type == "stream") for cell in notebook.cells]
    seen = [line.rsplit("\r", 1)[-1] for text in streams for line in text.split("\n")]
    assert all("it/s" not in line and "s/it" not in line for line in seen), "no bar is left"


def test_the_workflow_of_releases():
    import yaml

    path = ROOT / ".github/workflows/wheels.yml"
    workflow = yaml.safe_load(path.read_text())
    # YAML 1.1 reads `on` as true.
    triggers = workflow.get("on", workflow.get(True))
    assert "tags" in triggers["push"] and "workflow_dispatch" in triggers
    jobs = workflow["jobs"]
    assert set(jobs) == {"wheels", "sdist", "release"}
    for job in jobs.values():
        assert job["runs-on"] and job["steps"]
        assert all("uses" in step or "run" in step for step in job["steps"])
        for need in np.atleast_1d(job.get("needs", [])):
            assert need in jobs
    uses = [step["uses"] for job in jobs.values() for step in job["steps"] if "uses" in step]
    assert all("@" in each for each in uses)
    systems = jobs["wheels"]["strategy"]["matrix"]["include"]
    assert {each["os"].split("-")[0] for each in systems} == {"ubuntu", "macos", "windows"}
    assert jobs["release"]["permissions"] == {"id-token": "write"}
    assert "startsWith(github.ref, 'refs/tags/v')" in jobs["release"]["if"]


def test_source_distribution(tmp_path):
    """The archive holds all crates that the wheel needs, and the lock file."""
    import shutil
    import tarfile

    if shutil.which("maturin") is None:
        command = [sys.executable, "-m", "maturin"]
        if subprocess.run([*command, "--version"], capture_output=True).returncode != 0:
            pytest.skip("maturin is not installed")
    else:
        command = ["maturin"]
    run = subprocess.run([*command, "sdist", "--out", str(tmp_path)], cwd=FOLDER, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    [archive] = tmp_path.glob("*.tar.gz")
    names = tarfile.open(archive).getnames()
    for part in ("Cargo.lock", "crates/poly/Cargo.toml", "crates/hc/Cargo.toml", "crates/tdoa/Cargo.toml", "tdoa/__init__.py"):
        assert any(name.endswith(part) for name in names), part
    assert os.path.getsize(archive) < 5_000_000
