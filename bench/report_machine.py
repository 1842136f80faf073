"""Writes what the measurements ran on: report_machine.py <build folder> <CSV file>."""

import csv
import datetime
import os
import re
import subprocess
import sys
from pathlib import Path

INSTRUCTIONS = [("avx512f", "AVX-512"), ("avx2", "AVX2")]    # first match: what the kernels use


def read_processor():
    """Name of the processor and its vector instructions."""
    text = Path("/proc/cpuinfo").read_text()
    name = re.search(r"model name\s*:\s*(.*)", text)
    flags = re.search(r"flags\s*:\s*(.*)", text)
    names = flags.group(1).split() if flags else []
    vectors = next((label for flag, label in INSTRUCTIONS if flag in names), "no AVX2")
    return f"{name.group(1) if name else 'unknown'}, {vectors}, {os.cpu_count()} cores"


def read_compiler(build):
    """Compiler, its version, and the flags that CMake was given."""
    cache = (build / "CMakeCache.txt").read_text()
    values = dict(re.findall(r"^(\w+):\w+=(.*)$", cache, re.MULTILINE))
    version = subprocess.run([values["CMAKE_CXX_COMPILER"], "--version"], check=True,
                             capture_output=True, text=True).stdout.splitlines()[0]
    native = ", for this processor" if values.get("BIEM_NATIVE", "ON").upper() == "ON" else ""
    return f"{version}, {values['CMAKE_BUILD_TYPE'] or 'Release'}{native}"


def main():
    build, target = Path(sys.argv[1]), Path(sys.argv[2])
    with target.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["processor", "compiler", "date"])
        writer.writerow([read_processor(), read_compiler(build), datetime.date.today().isoformat()])


if __name__ == "__main__":
    main()
