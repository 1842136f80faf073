"""Single cells at the limits of moduli, viscosity ratios, shapes and meshes."""

import numpy as np

import hard_scene as scenes
from hard_case import Case, check_limits, describe, main, make_tests
from hard_scene import Scene

ONE = "create_cells rbc nodes {nodes} single 0 0 0 orientation -0.5 0 1\n"
TOLERANCE = "error/tolerance 1e-3" if scenes.STEPPER == "rkc2" else ""
LIMITS = {"volume": 1e-5, "area": 0.03, "angle": 5.0}


def run_shear(folder, size, **limits):
    scene = Scene(**{"bodies": ONE.format(nodes=size["nodes"]), **size})
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder)
    check_limits(found, {**LIMITS, **limits})
    second_half = outcome.rows["time"] > 0.5 * scene.end
    angle = np.mean(outcome.rows["inclination"][second_half])
    return f"{describe(found)}, mean inclination {angle:.1f} deg in the second half"


def run_ratio(ratio):
    def run(folder, size):
        return run_shear(folder, {**size, "surfaces": f"viscosity/ratio {ratio}"}, iterations=60)
    return run


def run_moduli(folder, size):
    """Each ratio is a run; the stiffer the membrane, the smaller its area changes."""
    found = []
    for ratio in (1.0, 10.0, 100.0, 1000.0):
        scene = Scene(bodies=ONE.format(nodes=size["nodes"]), shear=2.0, dilatation=2.0 * ratio,
                      **size)
        outcome = scenes.run(scene.make_script(), folder).require_success()
        found.append(scenes.measure(outcome, folder))
        check_limits(found[-1], {"volume": 1e-5, "angle": 5.0})
    areas = [f["area"] for f in found]
    if areas != sorted(areas, reverse=True):
        raise AssertionError(f"area changes {areas} do not fall with ED/ES")
    return "; ".join(f"ED/ES {ratio}: area change {f['area']:.2e}, {f['evaluations']:.0f} "
                     "evaluations per unit time" for ratio, f in zip((1, 10, 100, 1000), found))


def run_elongated(folder, size):
    """Stretched to three times its length at the same volume, in fluid at rest: the membrane only
    loses energy."""
    left, size = size["left"], {key: size[key] for key in size if key != "left"}
    stretch, radius = 3.0, 1.5
    thin = stretch ** -0.5 - 1.0
    ramps = "".join(f"displace_atoms all ramp {axis} {-radius * f} {radius * f} {axis} {-radius} "
                    f"{radius} units box\n"
                    for axis, f in (("x", stretch - 1.0), ("y", thin), ("z", thin)))
    scene = Scene(box=(-5.0, 5.0, -3.0, 3.0, -3.0, 3.0), flow="none", forces=ramps, strain=10.0,
                  more=TOLERANCE,
                  bodies=f"create_cells rbc nodes {size['nodes']} single 0 0 0\n", **size)
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder)
    check_limits(found, {"volume": 1e-5})
    energy = outcome.rows["energy"]
    if np.any(np.diff(energy) > 1e-6 * energy[0]):
        raise AssertionError(f"the energy grows by {np.max(np.diff(energy)):.3g} in a step")
    if not energy[-1] < left * energy[0]:
        raise AssertionError(f"the energy falls to {energy[-1] / energy[0]:.3g} of the first only")
    return f"{describe(found)}, energy {energy[0]:.4g} falls in every step, to {energy[-1]:.4g}"


def make_globe_off(meridians, parallels):
    """OFF text of an ellipsoid with slivers at its poles; counter-clockwise from outside."""
    points = [(0.0, 0.0, 0.5)]
    for i in range(1, parallels):
        for j in range(meridians):
            u, v = np.pi * i / parallels, 2.0 * np.pi * (j + 0.5 * (i % 2)) / meridians
            points.append((np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), 0.5 * np.cos(u)))
    points.append((0.0, 0.0, -0.5))
    last = len(points) - 1

    def node(i, j):
        return 1 + (i - 1) * meridians + j % meridians

    triangles = [(0, node(1, j), node(1, j + 1)) for j in range(meridians)]
    triangles += [(last, node(parallels - 1, j + 1), node(parallels - 1, j))
                  for j in range(meridians)]
    for i in range(1, parallels - 1):
        for j in range(meridians):
            k = j if i % 2 else j - 1
            triangles += [(node(i, j), node(i + 1, k + 1), node(i, j + 1)),
                          (node(i, j), node(i + 1, k), node(i + 1, k + 1))]
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += ["%.9g %.9g %.9g" % p for p in points] + ["3 %d %d %d" % t for t in triangles]
    return "\n".join(lines) + "\n"


def run_bad_mesh(folder, size):
    (folder / "globe.off").write_text(make_globe_off(size["meridians"], size["parallels"]))
    scene = Scene(bodies="create_cells mesh globe.off radius 1 single 0 0 0\n",
                  nodes=4 * size["meridians"] ** 2,    # mean edge of the thin triangles
                  **{k: size[k] for k in ("end", "timestep") if k in size})
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder)
    check_limits(found, {"volume": 1e-5, "angle": 1.0})
    return describe(found)


CASES = [
    Case("Ca 2", "to t = 50: volume within 1e-5, area within 3 %, no triangle below 5 degrees",
         run_shear, {"capillary_number": 2.0, "nodes": 42, "end": 3.0},
         {"capillary_number": 2.0, "nodes": 642, "end": 50.0, "frames": 50}),
    Case("Ca 0.1", "buckling cell, to t = 50: the same", run_shear,
         {"capillary_number": 0.1, "nodes": 42, "end": 3.0},
         {"capillary_number": 0.1, "nodes": 642, "end": 50.0, "frames": 50}),
    Case("Viscosity ratio 0.1", "to t = 10: the same, at most 60 iterations", run_ratio(0.1),
         {"nodes": 42, "end": 0.5}, {"nodes": 162, "end": 10.0, "frames": 10}),
    Case("Viscosity ratio 20", "to t = 10: the same, at most 60 iterations", run_ratio(20.0),
         {"nodes": 42, "end": 0.5}, {"nodes": 162, "end": 10.0, "frames": 10}),
    Case("ED/ES 1 to 1000", "stable at the same time step; area changes fall with ED", run_moduli,
         {"nodes": 42, "end": 0.5}, {"nodes": 162, "end": 5.0}),
    Case("Very elongated cell", "three times its length, released, with error/tolerance 1e-3: "
         "energy falls in every step to below 1 %, volume within 1e-5", run_elongated,
         {"nodes": 42, "end": 1.0, "left": 0.1},
         {"nodes": 642, "end": 20.0, "frames": 20, "left": 0.01}),
    Case("Bad triangles", "mesh with slivers at two poles: volume within 1e-5, no triangle below 1 "
         "degree", run_bad_mesh, {"meridians": 24, "parallels": 6, "end": 0.2},
         {"meridians": 60, "parallels": 12, "end": 5.0}),
]
HardCases = make_tests(CASES)

if __name__ == "__main__":
    main()
