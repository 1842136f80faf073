"""What input scripts of lmp_biem begin with, and runs of one in a folder.
Knows nothing of scenes and of what is tested."""

import os
import subprocess
from pathlib import Path

SOURCE = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[1]))
LMP = os.environ.get("BIEM_LMP", str(SOURCE / "build" / "lmp_biem"))

HEADER = """units lj
newton on
atom_style molecular
atom_modify map yes
boundary p p p
"""


def run_script(script, folder):
    """Output of a run on one rank that has to succeed."""
    (Path(folder) / "in.script").write_text(script)
    done = subprocess.run([LMP, "-in", "in.script", "-log", "none"], cwd=folder,
                          capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"lmp_biem failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout
