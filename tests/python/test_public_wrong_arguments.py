"""Any input to the public names ends in a result or in Error.

Crashes, hangs and other tracebacks are failures.
"""

import subprocess
import sys
from pathlib import Path

import pytest
from sampling import sample
from wrong_arguments import ARGUMENTS, FITS

import brushsvg

MODULES = ("laws",)
BATCHES = 6
LONG_S = 300  # catches a hang; it does not limit the speed


def test_every_public_name_is_tested():
    inside = {f"{module}.{name}" for module in MODULES for name in getattr(brushsvg, module).__all__}
    assert set(ARGUMENTS) == (set(brushsvg.__all__) | inside) - {"__version__", *MODULES}


@sample("batch", range(BATCHES), keep=2)
@pytest.mark.slow
def test_invalid_arguments_give_a_result_or_a_refusal(batch, tmp_path):
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("wrong_arguments.py"), *sorted(ARGUMENTS | FITS)[batch::BATCHES]],
        capture_output=True,
        text=True,
        errors="replace",
        cwd=tmp_path,
        timeout=LONG_S,
    )
    assert done.returncode == 0, done.stderr.splitlines()[-5:]
    assert done.stdout == ""
