"""The program that comes with the package."""

import subprocess
import sys

import keyway

KEYWAY = [sys.executable, "-m", "keyway"]


def test_the_program_answers() -> None:
    listed = subprocess.run([*KEYWAY, "list"], capture_output=True, text=True, check=True)
    for kind in ("planners", "smoothers", "stacks", "robots"):
        assert all(name in listed.stdout for name in keyway.names(kind))
    version = subprocess.run([*KEYWAY, "--version"], capture_output=True, text=True, check=True)
    # Python spells versions in its own way: 0.1.0a1 is 0.1.0-alpha.1.
    assert version.stdout.split() == ["keyway", keyway.__version__.replace("a", "-alpha.")]
    refused = subprocess.run([*KEYWAY, "plan", "nowhere.yaml", "--start", "0,0", "--goal", "1,1"], capture_output=True, text=True)
    assert refused.returncode == 2 and "cannot read nowhere.yaml" in refused.stderr
