"""What the tests share: the repository, and its programs."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
os.environ.setdefault("MPLBACKEND", "Agg")


def built(name):
    """The program of that name: the one that HC_PROGRAM or TDOA_PROGRAM names, else one built anew, as the wheel is."""
    given = os.environ.get(f"{name.upper()}_PROGRAM")
    if given:
        return given
    command = ["cargo", "build", "--quiet", "--locked", "--profile", "wheel", "-p", "hc-cli", "-p", "tdoa-cli"]
    subprocess.run(command, cwd=ROOT, check=True)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    return str(target / "wheel" / name)


@pytest.fixture(scope="session")
def programs():
    return {name: built(name) for name in ("hc", "tdoa")}


@pytest.fixture(scope="session")
def run_json(programs):
    """Runs a program with --json and gives what it writes."""

    def run(program, *arguments):
        command = [programs[program], *map(str, arguments), "--json", "-"]
        output = subprocess.run(command, capture_output=True, text=True, timeout=600)
        assert output.returncode in (0, 1), output.stderr
        return json.loads(output.stdout)

    return run


@pytest.fixture
def script(tmp_path):
    """Runs Python code in a process of its own; gives its standard output."""

    def run(code, **options):
        path = tmp_path / "code.py"
        path.write_text(code)
        command = [sys.executable, str(path)]
        output = subprocess.run(command, capture_output=True, text=True, timeout=120, **options)
        assert output.returncode == 0, output.stderr
        return output.stdout

    return run
