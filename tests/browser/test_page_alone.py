"""The page where no network is: server and browser in a namespace with the loopback interface alone."""

import os
import shutil
import subprocess
import sys

import pytest
from served import ROOT, chromium


@pytest.mark.verify
def test_lessons_tasks_and_a_killed_server_need_no_network() -> None:
    """Each page of these tests refuses a request to another host, see `page` in conftest.py."""
    pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install playwright")
    apart = ["unshare", "--map-root-user", "--net", "sh", "-c"]
    if chromium() is None or not shutil.which("unshare") or not shutil.which("ip"):
        pytest.skip("needs chromium, unshare and ip")
    if subprocess.run([*apart, "ip link set lo up"], capture_output=True, check=False).returncode:
        pytest.skip("this user may not make a namespace of networks")
    seen = subprocess.run([*apart, "ip link set lo up; ip -o link"], capture_output=True, text=True, check=True).stdout
    assert [line.split(":")[1].strip() for line in seen.splitlines() if "DOWN" not in line] == ["lo"]
    tests = ["tests/browser/test_page_whole.py", "tests/browser/test_page_tasks.py"]
    command = [sys.executable, "-m", "pytest", "-n", "0", "-q", "-m", "", "-p", "no:cacheprovider", *tests]
    command += ["-k", "ten_lessons or dead_server or begun_anew or stand or centro"]
    env = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    done = subprocess.run(
        [*apart, 'ip link set lo up && exec "$@"', "sh", *command], cwd=ROOT, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    assert "5 passed" in done.stdout
