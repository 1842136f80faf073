"""Surfaces that nearly touch: gaps, cells pressed together, a narrow duct, a dense suspension."""

import numpy as np

import hard_measures as measures
import hard_scene as scenes
from hard_case import Case, check_limits, describe, main, make_tests
from hard_scene import Scene

TOLERANCE = "error/tolerance 1e-3" if scenes.STEPPER == "rkc2" else ""
CONTACT = "pair_style biem/contact 0.05\npair_coeff * * 50.0"
LIMITS = {"volume": 1e-5, "inside": 0}
MOVE = "displace_atoms {group} move {x!r} {y!r} {z!r} units box\n"
RBC = "create_cells rbc nodes {nodes} single {x!r} {y!r} {z!r} orientation {turn} group {group}\n"


def make_rbc(nodes, center, turn="0 0 1", group="cells"):
    x, y, z = center
    return RBC.format(nodes=nodes, x=x, y=y, z=z, turn=turn, group=group)


def make_move(group, x, y, z):
    """create_cells asks for more than the gap of the meshes, so bodies are put far apart first."""
    return MOVE.format(group=group, x=x, y=y, z=z)


def find_gap(scene, folder):
    """Gap of the surfaces as created."""
    script = (scene.make_start() + "write_data start.data nocoeff nofix\n"
              "write_dump all custom start.dump id mol type xu yu zu modify sort id "
              "format float %.15g\n")
    scenes.run(script, folder).require_success()
    frame = measures.read_frames(folder / "start.dump")[0]
    surfaces = measures.Surfaces(frame, measures.read_triangles(folder / "start.data"))
    return measures.find_contacts(frame, surfaces)[0]


def close_gap(make_scene, folder, distance, gap):
    """The scene of make_scene(distance) with that gap, from a distance at which the gap is more."""
    for _ in range(12):
        found = find_gap(make_scene(distance), folder)
        if abs(found - gap) < 0.03 * gap:
            return make_scene(distance)
        distance -= found - gap
    raise AssertionError(f"no distance with a gap of {gap} was found, the last one has {found}")


def run_gap(make_scene, distance):
    """From a gap of 0.01."""
    def run(folder, size):
        scene = close_gap(lambda d: make_scene(d, size), folder, distance, 0.01)
        outcome = scenes.run(scene.make_script(), folder).require_success()
        found = scenes.measure(outcome, folder, contacts=True)
        check_limits(found, {**LIMITS, "gap": 1e-4})
        return describe(found)
    return run


def make_two_cells(distance, size):
    """On the line along which the shear flow pushes them together."""
    s = float(distance * np.sqrt(0.125))
    turn = "1 0 1"
    return Scene(bodies=make_rbc(size["nodes"], (-1.5, 0.0, 1.5), turn, "one")
                 + make_rbc(size["nodes"], (1.5, 0.0, -1.5), turn, "other")
                 + make_move("one", 1.5 - s, 0, s - 1.5) + make_move("other", s - 1.5, 0, 1.5 - s),
                 **size)


def make_cell_wall(distance, size):
    """Upright before a wall, dragged along it."""
    return Scene(box=(-3.0, 3.0, -2.5, 2.5, 0.0, 6.0), flow="mean 1 0 0",
                 bodies="create_wall plane z 0 edge 0.5 group walls type 3 angle_type 2\n"
                 + make_rbc(size["nodes"], (0.0, 0.0, 3.0), "1 0 0")
                 + make_move("cells", 0, 0, distance - 3.0),
                 surfaces="cells cells wall walls", **size)


def make_cell_platelet(distance, size):
    s = float(distance * np.sqrt(0.5))
    return Scene(bodies=make_rbc(size["nodes"], (0.0, 0.0, 0.0), "1 0 1")
                 + "create_cells platelet diameter 0.993 thickness 0.248 nodes 42 single "
                 "-1.5 0 1.5 orientation 1 0 -1 type 2 angle_type 2 dihedral_type 2 "
                 "group platelets\n"
                 + make_move("platelets", 1.5 - s, 0, s - 1.5),
                 surfaces="cells cells rigid platelets", **size)


def make_pressed(size):
    force = size["force"] / size["scene"]["nodes"]
    nodes = size["scene"]["nodes"]
    return Scene(bodies=make_rbc(nodes, (0.0, 0.0, -0.9), group="lower")
                 + make_rbc(nodes, (0.0, 0.0, 0.9), group="upper")
                 + make_move("lower", 0, 0, 0.35) + make_move("upper", 0, 0, -0.35), flow="none",
                 forces=f"fix up lower addforce 0 0 {force!r}\n"
                        f"fix down upper addforce 0 0 {-force!r}\n", pair=CONTACT, **size["scene"])


def run_pressed(folder, size):
    outcome = scenes.run(make_pressed(size).make_script(), folder).require_success()
    found = scenes.measure(outcome, folder, contacts=True)
    check_limits(found, {**LIMITS, "gap": 1e-3})
    return f"force {size['force']}: {describe(found)}"


def duct_half_width(x, length, wide, narrow):
    return 0.5 * (narrow + (wide - narrow) * np.cos(np.pi * x / length) ** 4)


def duct_size(y, z):
    """Half width of the rounded square on which the point is."""
    return (y ** 8 + z ** 8) ** 0.125


def make_duct_off(length, wide, narrow, steps):
    """Duct along x of rounded square section, `wide` at its ends and `narrow` in the middle;
    corners counter-clockwise from inside."""
    n, around = steps
    x = np.linspace(0.0, length, n + 1)
    half = duct_half_width(x, length, wide, narrow)
    turn = 2.0 * np.pi * np.arange(around) / around
    c, s = np.cos(turn), np.sin(turn)
    shape = 1.0 / duct_size(c, s)
    points = [(x[i], half[i] * shape[j] * c[j], half[i] * shape[j] * s[j])
              for i in range(n + 1) for j in range(around)]

    def node(i, j):
        return i * around + j % around

    triangles = [t for i in range(n) for j in range(around) for t in
                 ((node(i, j), node(i + 1, j), node(i + 1, j + 1)),
                  (node(i, j), node(i + 1, j + 1), node(i, j + 1)))]
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += ["%.9g %.9g %.9g" % p for p in points] + ["3 %d %d %d" % t for t in triangles]
    return "\n".join(lines) + "\n"


def run_duct(folder, size):
    """A cell 2.8 wide in a duct that narrows from 4 to 1.6, driven by a pressure drop."""
    length, widths = 10.0, (4.0, 1.6)
    (folder / "duct.off").write_text(make_duct_off(length, *widths, size["steps"]))
    scene = Scene(box=(0.0, length, -2.4, 2.4, -2.4, 2.4), flow=f"pressure/drop {size['drop']} 0 0",
                  bodies=make_rbc(size["scene"]["nodes"], (size["start"], 0.0, 0.0), "1 0 0")
                  + "create_wall mesh duct.off group walls type 3 angle_type 2\n",
                  surfaces="cells cells wall walls", pair=CONTACT, **size["scene"])
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder, contacts=True)
    check_limits(found, {**LIMITS, "gap": 1e-3, "volume": 1e-4})
    for frame in measures.read_frames(folder / "cells.dump"):
        x, y, z = frame.positions[frame.types == 1].T
        if np.any(duct_size(y, z) > duct_half_width(x, length, *widths)):
            raise AssertionError(f"nodes of the cell are outside the duct in step {frame.step}")
    traveled = outcome.rows["x"][-1] - size["start"]
    if traveled < size["way"]:
        raise AssertionError(f"the cell has moved by {traveled:.3f} only: {describe(found)}")
    return f"{describe(found)}, moved by {traveled:.2f}"


def run_dense(folder, size):
    scene = Scene(box=tuple(size["box"]), pair=CONTACT,
                  bodies=f"create_cells rbc nodes {size['scene']['nodes']} hematocrit 0.45 4711 "
                  f"gap {size['gap']}\n", **size["scene"])
    outcome = scenes.run(scene.make_script(), folder).require_success()
    found = scenes.measure(outcome, folder, contacts=True)
    check_limits(found, {**LIMITS, "area": 0.05, "angle": 3.0})
    return describe(found)


CASES = [
    Case("Gap 0.01 between two cells", "pushed together by shear: no point inside the other cell, "
         "gap above 1e-4, volume within 1e-5", run_gap(make_two_cells, 3.2),
         {"nodes": 42, "end": 0.5}, {"nodes": 642, "end": 10.0, "frames": 20}),
    Case("Gap 0.01 between cell and wall", "the same", run_gap(make_cell_wall, 1.6),
         {"nodes": 42, "end": 0.5}, {"nodes": 642, "end": 10.0, "frames": 20}),
    Case("Gap 0.01 between cell and platelet", "the same", run_gap(make_cell_platelet, 1.8),
         {"nodes": 42, "end": 0.5}, {"nodes": 642, "end": 10.0, "frames": 20}),
    Case("Two cells pressed together", "by a constant force, with pair biem/contact: gap above "
         "1e-3, no point inside, volume within 1e-5", run_pressed,
         {"force": 20.0, "scene": {"nodes": 42, "end": 1.0}},
         {"force": 20.0, "scene": {"nodes": 642, "end": 20.0, "frames": 20}}),
    Case("Cell squeezed through a duct of 1.6 a", "driven by a pressure drop, with pair "
         "biem/contact and error/tolerance 1e-3: gap above 1e-3, no node outside the duct, "
         "volume within 1e-4", run_duct,
         {"steps": (20, 24), "drop": 12.0, "start": 1.5, "way": 0.05,
          "scene": {"nodes": 42, "end": 0.1}},
         {"steps": (40, 48), "drop": 12.0, "start": 0.5, "way": 7.0,
          "scene": {"nodes": 642, "end": 6.0, "frames": 20, "more": TOLERANCE}}),
    Case("Hematocrit 0.45", "Ca 1, in shear to t = 20, with pair biem/contact and "
         "error/tolerance 1e-3: no point inside another cell, area within 5 %, no triangle "
         "below 3 degrees", run_dense,
         {"box": (0, 4.6, 0, 4.6, 0, 4.6), "gap": 0.02,
          "scene": {"nodes": 42, "end": 0.3}},
         {"box": (0, 5.3, 0, 4.6, 0, 4.6), "gap": 0.02,
          "scene": {"nodes": 642, "end": 20.0, "frames": 4, "more": TOLERANCE}}),
]
HardCases = make_tests(CASES)

if __name__ == "__main__":
    main()
