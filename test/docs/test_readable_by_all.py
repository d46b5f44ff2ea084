"""A checkout below a folder that others may not enter, as root's home: `make test` failed there in tests that run as
another user."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from pages import REPOSITORY

ANYBODY = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]


@pytest.fixture
def checkout() -> Iterator[Path]:
    if os.geteuid() != 0:
        pytest.skip("needs root; others run everything as themselves")
    with tempfile.TemporaryDirectory() as folder:  # not that of pytest, which others may not enter
        Path(folder).chmod(0o755)
        tools = Path(folder) / "home" / "my checkout" / "tools"
        tools.mkdir(parents=True)
        shutil.copy(REPOSITORY / "tools" / "readable_by_all", tools)
        (tools / "told").write_text("told")
        yield tools.parent


def run(checkout: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([checkout / "tools/readable_by_all", *command], capture_output=True, text=True, check=False)


def test_anybody_may_read_it_at_its_own_path(checkout):
    (checkout.parent / "secret").write_text("kept")
    checkout.parent.chmod(0o700)
    assert run(checkout, *ANYBODY, "cat", str(checkout / "tools/told")).stdout == "told"
    assert run(checkout, *ANYBODY, "cat", str(checkout.parent / "secret")).returncode != 0
    there = run(checkout, "sh", "-c", "pwd; touch made; exit 3")
    assert (there.stdout, there.returncode) == (f"{checkout}\n", 3) and (checkout / "made").exists()
    assert (checkout.parent / "secret").read_text() == "kept"


def test_what_others_may_not_read_for_itself_is_told(checkout):
    checkout.chmod(0o700)
    done = run(checkout, "true")
    assert done.returncode == 0 and done.stdout.startswith(f"Others may not read {checkout}")


def test_where_anybody_may_read_it_nothing_is_done(checkout):
    assert run(checkout, "readlink", "/proc/self/ns/mnt").stdout == os.readlink("/proc/self/ns/mnt") + "\n"
    checkout.parent.chmod(0o700)
    assert run(checkout, "readlink", "/proc/self/ns/mnt").stdout != os.readlink("/proc/self/ns/mnt") + "\n"
