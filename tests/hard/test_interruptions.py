"""Runs that are killed, whose disk is full, whose time step is too large, whose box flips often."""

import os
import random
import re
import resource
import signal
import time

import numpy as np

import hard_measures as measures
import hard_scene as scenes
from hard_case import Case, describe, main, make_tests
from hard_scene import Scene
from lammps_scripts import HEADER

ONE = "create_cells rbc nodes {nodes} single 0 0 0 orientation -0.5 0 1\n"
CONTINUED = HEADER.replace("atom_style molecular\n", "") + """
read_restart {file}
neighbor 0.2 bin
"""


def run_flips(folder, size):
    """A stiff cell and four tracers in a low and long box: the tilt passes a box length four times
    per unit of strain."""
    tracers = "".join(f"create_atoms 4 single {x} 0.5 {z}\n" for x, z in
                      ((0.3, -5.0), (-0.7, -2.9), (1.0, 3.1), (0.2, 5.5)))
    scene = Scene(box=(-1.5, 1.5, -1.5, 1.5, -6.0, 6.0),
                  bodies=f"create_cells sphere radius 0.5 nodes {size['nodes']} single 0 0 0 "
                  f"group cells\n{tracers}group points type 4\n",
                  surfaces="cells cells tracers points", end=size["flips"] / 4.0 + 0.01,
                  capillary_number=size["Ca"])
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder)
    rows, last = outcome.rows, measures.read_frames(folder / "last.dump")[0]
    if abs(rows["flips"][-1] - size["flips"]) > 1:
        raise AssertionError(f"{rows['flips'][-1]:.0f} flips, expected {size['flips']}")
    tilt = last.lattice[2, 0] - 12.0 * rows["time"][-1]
    error = abs(tilt - 3.0 * np.round(tilt / 3.0))
    if not error < 1e-8 or not found["volume"] < 1e-5:
        raise AssertionError(f"the tilt is wrong by {error:.2e}: {describe(found)}")
    # A tracer far from the cell moves with the flow at its height, which hardly changes.
    x = last.positions[last.types == 4]
    height = np.array((-5.0, -2.9, 3.1, 5.5))
    drift = np.abs(x[:, 0] / (height * rows["time"][-1]) - 1.0).max()
    if not drift < size["drift"]:
        raise AssertionError(f"tracers are {drift:.2%} off the way of the flow")
    return (f"{rows['flips'][-1]:.0f} flips, tilt right to {error:.0e}, unwrapped tracers within "
            f"{drift:.1%} of the flow's way, {describe(found)}")


def run_large_step(folder, size):
    """Every step ends in one of two ways; garbage is a run that goes on with far too much power."""
    body = ONE.format(nodes=size["nodes"])
    reference = Scene(bodies=body, nodes=size["nodes"], end=size["end"])
    power = late_power(scenes.run(reference.make_script(), folder).require_success(), reference)
    texts = []
    for stepper, steps in size["steps"].items():
        for timestep in steps:
            scene = Scene(bodies=body, end=size["end"], nodes=size["nodes"], stepper=stepper,
                          timestep=timestep)
            outcome = scenes.run(scene.make_script(), folder)
            texts.append(f"{stepper} {timestep}: {judge(outcome, folder, power, scene)}")
    return "; ".join(texts)


def late_power(outcome, scene):
    """Mean over the second half of the run."""
    return np.mean(outcome.rows["power"][outcome.rows["time"] >= 0.5 * scene.end])


def judge(outcome, folder, power, scene):
    if outcome.status != 0:
        if not re.search(r"time ?step", outcome.error):
            raise AssertionError(f"stopped without advice: {outcome.error}")
        times = outcome.rows["time"]
        return "stopped with advice " + (f"at t = {times[-1]:.3g}" if len(times) else "at once")
    found = scenes.measure(outcome, folder)
    ratio = late_power(outcome, scene) / power
    if not (ratio < 2.0 and found["volume"] < 1e-2):
        raise AssertionError(f"{scene.stepper} {scene.timestep} is garbage: power {ratio:.3g} "
                             f"times that of a small step, {describe(found)}")
    return (f"stable, power {ratio:.2f} times that of a small step, volume error "
            f"{found['volume']:.0e}")


def read_positions(path):
    return measures.read_frames(path)[0].positions


def run_killed(folder, size):
    """SIGKILL at a random moment of a run that writes two restart files in turn. The newest one may
    be cut off: then the other one is used."""
    scene = Scene(bodies=ONE.format(nodes=size["nodes"]), nodes=size["nodes"], frames=1,
                  end=size["end"])
    begun = time.monotonic()
    scenes.run(scene.make_script(), folder).require_success()
    duration = time.monotonic() - begun
    whole = read_positions(folder / "last.dump")
    texts, chance = [], random.Random(os.getpid())
    for _ in range(size["times"]):
        for file in ("one", "two"):
            (folder / file).unlink(missing_ok=True)
        process = scenes.start(scene.make_script().replace(
            "run 100000000", f"restart {size['every']} one two\nrun 100000000"), folder)
        while process.poll() is None and not (folder / "two").exists():
            time.sleep(0.01)
        time.sleep(duration * chance.uniform(0.0, 0.5))
        process.send_signal(signal.SIGKILL)
        if process.wait() != -signal.SIGKILL:
            raise AssertionError("the run had ended before it was killed: nothing was tested")
        texts.append(continue_killed(scene, folder, whole))
    return "; ".join(texts)


def continue_killed(scene, folder, whole):
    files = sorted((f for f in (folder / "one", folder / "two") if f.exists()),
                   key=lambda f: f.stat().st_mtime, reverse=True)
    (folder / "last.dump").unlink(missing_ok=True)
    script = scene.make_styles() + scene.make_flow() + scene.make_run()
    refused = 0
    for file in files:
        outcome = scenes.run(CONTINUED.format(file=file.name) + script, folder)
        if outcome.status == 0:
            break
        refused += 1
    else:
        raise AssertionError(f"no restart file of {len(files)} can be used: {outcome.error}"
                             if files else "killed before the first restart file")
    error = np.abs(read_positions(folder / "last.dump") - whole).max()
    if not error < 1e-10:
        raise AssertionError(f"positions differ by {error:.2e} from the whole run")
    return (f"continued from step {outcome.rows['step'][0]:.0f}"
            + " (newest file cut off)" * refused + f", positions differ by {error:.0e}")


def run_until_full(script, folder, n_bytes):
    """From the first two restart files on, no file of the run may grow beyond n_bytes."""
    process = scenes.start(script, folder, lambda: signal.signal(signal.SIGXFSZ, signal.SIG_IGN))
    while process.poll() is None and not (folder / "two").exists():
        time.sleep(0.005)
    if n_bytes and process.poll() is None:
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (n_bytes, n_bytes))
    return scenes.finish(process, folder)


def run_full_disk(folder, size):
    """Files may not grow beyond a limit that the dump reaches and the restart files do not; then a
    device that is always full."""
    scene = Scene(bodies=ONE.format(nodes=size["nodes"]), nodes=size["nodes"], end=size["end"])
    script = re.sub(r"dump d all custom \d+", "dump d all custom 1", scene.make_script())
    script = script.replace("run 100000000", "restart 5 one two\nrun 100000000")
    texts = []
    for name, text, limit in (("limited file size", script, size["bytes"]),
                              ("/dev/full", script.replace("cells.dump", "/dev/full"), None)):
        for file in ("one", "two"):
            (folder / file).unlink(missing_ok=True)
        outcome = run_until_full(text, folder, limit)
        texts.append(f"{name}: " + (f"stopped, '{outcome.error[:100]}'" if outcome.status else
                                    "the run goes on, without a message"))
        if limit and (folder / "cells.dump").stat().st_size > limit:
            raise AssertionError("the dump was not cut off: nothing was tested")
        for file in ("one", "two"):
            again = CONTINUED.format(file=file) + scene.make_styles() + scene.make_flow()
            outcome = scenes.run(again + "run 0\n", folder).require_success()
        texts[-1] += f", restart files readable up to step {outcome.rows['step'][0]:.0f}"
    return "; ".join(texts)


CASES = [
    Case("1000 tilt flips", "tilt right to 1e-8, volume within 1e-5, unwrapped tracers go on "
         "with the flow", run_flips, {"nodes": 42, "flips": 100, "Ca": 0.2, "drift": 0.3},
         {"nodes": 42, "flips": 1000, "Ca": 0.2, "drift": 0.3}),
    Case("Large time step", "either stable or stopped with advice, never garbage", run_large_step,
         {"nodes": 42, "end": 4.0, "steps": {"rkc2": (0.5, 4.0), "ab2": (0.02, 0.1),
                                             "euler": (0.03, 0.1)}},
         {"nodes": 162, "end": 10.0, "steps": {"rkc2": (0.1, 0.2, 0.5, 1.0, 2.0, 5.0),
                                               "ab2": (0.006, 0.008, 0.012, 0.05, 0.5),
                                               "euler": (0.01, 0.014, 0.02, 0.1, 0.5)}}),
    Case("Killed and continued", "SIGKILL at a random moment; from the last restart the same "
         "positions to 1e-10", run_killed, {"nodes": 162, "end": 10.0, "every": 20, "times": 1},
         {"nodes": 642, "end": 20.0, "every": 20, "times": 5}),
    Case("Disk full while dumping", "the run stops with a message or goes on; restart files stay "
         "readable", run_full_disk, {"nodes": 42, "end": 5.0, "bytes": 100000},
         {"nodes": 642, "end": 5.0, "bytes": 1500000}),
]
HardCases = make_tests(CASES)

if __name__ == "__main__":
    main()
