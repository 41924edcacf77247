"""What the tests share: the repository, and its programs."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
os.environ.setdefault("MPLBACKEND", "Agg")


BUILD = ["cargo", "build", "--release", "--locked", "-p", "hc-cli", "-p", "tdoa-cli"]


def built(names, capture):
    """The programs of these names, built as the guide builds them, with what cargo says on the terminal."""
    with capture.global_and_fixture_disabled():
        print(f"\nNo HC_PROGRAM and TDOA_PROGRAM: {' '.join(BUILD)}", flush=True)
        subprocess.run(BUILD, cwd=ROOT, check=True)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return {name: str(ROOT / target / "release" / name) for name in names}


@pytest.fixture(scope="session")
def programs(request):
    """The programs that HC_PROGRAM and TDOA_PROGRAM name; those that no variable names are built."""
    given = {name: os.environ.get(f"{name.upper()}_PROGRAM") for name in ("hc", "tdoa")}
    missing = [name for name, program in given.items() if not program]
    if missing:
        given |= built(missing, request.config.pluginmanager.getplugin("capturemanager"))
    return given


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
