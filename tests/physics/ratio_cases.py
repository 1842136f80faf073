"""A sphere of a membrane with another viscosity inside: exact linear response, and the same
response measured with lmp_biem.

Exact: Stokes flow of the second spherical harmonic around and inside the unit sphere. E is a
traceless tensor, n the unit normal. Fields at the surface have two components, of E.n and of
(n.E.n) n. Viscosity outside 1, inside lambda.
  inside   u = E.x                          traction 2 lambda (1, 0)
           u = 5 r^2 E.x - 2 (x.E.x) x      traction lambda (16, -19)
  outside  u = (x.E.x) x / r^5              traction (2, -8)
           u = 2 E.x / r^5 - 5 (x.E.x) x / r^7,     traction (-16, 40)
  flow     u = E.x                          traction 2 (1, 0)
A membrane (shear modulus ES, area modulus ES + ED) displaced by a E.n + b (n.E.n) n is under
the tension  2 ES a P.E.P + [2 ES b + ED (2 b - a)] (n.E.n) P,  P = I - n n, whose divergence is
the force density on the fluid:  2 ES a (-3, 4) + [2 ES b + ED (2 b - a)] (2, -4).
The velocity is continuous; force = traction inside - traction outside."""

import csv
import tempfile
from pathlib import Path

import numpy as np

from lammps_scripts import HEADER, SOURCE
from styles import membrane_cases as cases

AMPLITUDE = 1e-5
E_XZ = np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])    # of the shear u = (z, 0, 0)

SETUP = HEADER + """region box prism -{half} {half} -{half} {half} -{half} {half} 0 0 0
create_box 1 box angle/types 1 dihedral/types 1
mass 1 1.0
create_cells {shape} nodes {nodes} single 0 0 0
pair_style none
angle_style biem/skalak
angle_coeff 1 1.0 1.0
dihedral_style zero
dihedral_coeff *
neighbor 0.3 bin
compute ref all property/atom d2_biem_reference[1] d2_biem_reference[2] d2_biem_reference[3]
compute current all reduce max c_ref[1] c_ref[2] c_ref[3]
variable r atom sqrt(c_ref[1]^2+c_ref[2]^2+c_ref[3]^2)
variable q atom c_ref[1]*c_ref[3]/v_r^2
"""

FLOW = """
fix b all biem viscosity 1.0 accuracy {accuracy} flow {flow} traction {traction} &
  {surface}
thermo_style custom step f_b[11] f_b[1][8] f_b[1][21] c_current[1]
thermo_modify norm no format float %.16g
run 0
write_dump all custom {file} id x y z f_b[1] f_b[2] f_b[3] f_b[7] modify sort id format float %.17g
unfix b
"""

STEPS = """
timestep {timestep}
fix b all biem viscosity 1.0 accuracy 1e-3 flow shear xz 1.0 traction consistent &
  viscosity/ratio {ratio}
compute cell all biem/cell
thermo_style custom step c_cell[1][8] c_cell[1][23]
thermo_modify format float %.12g
thermo {steps}
run {steps}
"""

# a: displacement along E.n, b: along (n.E.n) n
DISPLACE = """
variable nx atom c_ref[1]+{a}*0.5*c_ref[3]/v_r+{b}*v_q*c_ref[1]/v_r
variable ny atom c_ref[2]+{b}*v_q*c_ref[2]/v_r
variable nz atom c_ref[3]+{a}*0.5*c_ref[1]/v_r+{b}*v_q*c_ref[3]/v_r
set group all x v_nx y v_ny z v_nz
"""


def compute_exact_response(ratio):
    """mobility (2, 2): force density -> velocity, and flow (2,): velocity in the flow E.x."""
    inside, outside = np.array([[1.0, 5.0], [0.0, -2.0]]), np.array([[0.0, 2.0], [1.0, -5.0]])
    traction_inside = ratio * np.array([[2.0, 16.0], [0.0, -19.0]])
    traction_outside = np.array([[2.0, -16.0], [-8.0, 40.0]])
    system = np.block([[inside, -outside], [traction_inside, -traction_outside]])
    inner = inside @ np.linalg.inv(system)[:2]
    return inner[:, 2:], inner @ np.array([1.0, 0.0, 2.0, 0.0])


def compute_exact_matrices(ratio):
    """Rates (2, 2) per ES and per ED, and flow (2,): d(a, b)/dt = (ES J0 + ED J1)(a, b) + flow."""
    mobility, flow = compute_exact_response(ratio)
    shear = np.array([[-6.0, 4.0], [8.0, -8.0]])
    dilatation = np.array([[-2.0, 4.0], [4.0, -8.0]])
    return mobility @ shear, mobility @ dilatation, flow


def compute_observables(matrices, C):
    """D/Ca, slope of the angle, slow rate, fast rate for ES = 1, ED = 2 C."""
    shear, dilatation, flow = matrices
    rates = shear + 2.0 * C * dilatation
    steady = -np.linalg.solve(rates, flow)
    # The vorticity turns the steady shape out of the straining axis: of the next order in Ca.
    turned = -np.linalg.solve(rates, steady)
    slow, fast = np.sort(-np.linalg.eigvals(rates).real)
    return np.array([0.5 * steady.sum(), 0.5 * turned.sum() / steady.sum(), slow, fast])


def compute_steady_shear(ratio, C, Ca):
    """Taylor deformation and inclination (degrees) in shear, linear in the deformation only: the
    vorticity turns the shape against the relaxation, (J + i) w = -flow with ES = 1/Ca."""
    shear, dilatation, flow = compute_exact_matrices(ratio)
    rates = (shear + 2.0 * C * dilatation) / Ca
    steady = -np.linalg.solve(rates + 1j * np.eye(2), flow).sum()
    return 0.5 * abs(steady), 45.0 - 0.5 * abs(np.degrees(np.angle(steady)))


def run_steady_shear(nodes, ratio, C, Ca, timestep, duration):
    """The same at the end of a run with time steps, from a sphere; consistent traction."""
    script = SETUP.format(half=6.0, shape="sphere radius 1", nodes=nodes)
    script += f"angle_coeff 1 {1.0 / Ca} {2.0 * C / Ca}\n"
    script += STEPS.format(ratio=ratio, timestep=timestep, steps=round(duration / timestep))
    with tempfile.TemporaryDirectory() as folder:
        row = cases.run_thermo(script, folder)[-1]
    return row["c_cell[1][8]"], row["c_cell[1][23]"]


def read_reference():
    """{(C, lambda): D/Ca, slope of the angle, slow rate, fast rate}."""
    path = SOURCE / "tests" / "reference" / "membrane_linear_response.csv"
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    names = ("D_over_Ca", "angle_slope", "slow_rate", "fast_rate")
    return {(float(r["C"]), float(r["lambda"])): np.array([float(r[name]) for name in names])
            for r in csv.DictReader(lines)}


def run_frames(shape, nodes, surface, parts, box):
    """Frames and thermo rows of a script; surface: 'rigid all' or 'cells all ...'; parts: lines
    with {file} where a dump is written."""
    script = SETUP.format(half=0.5 * box, shape=shape, nodes=nodes)
    for k, part in enumerate(parts):
        script += part.replace("{file}", f"frame.{k}")
    with tempfile.TemporaryDirectory() as folder:
        rows = cases.run_thermo(script.replace("{surface}", surface), folder)
        frames = [np.loadtxt(Path(folder) / f"frame.{k}", skiprows=9) for k in range(len(parts))]
    return frames, rows


def make_flow(flow, accuracy=1e-5, traction="lumped"):
    """The part of a script that evaluates the velocities once."""
    return (FLOW.replace("{flow}", flow).replace("{accuracy}", repr(accuracy))
            .replace("{traction}", traction))


def fit_modes(frame, directions):
    """Components of the velocity along E.n and (n.E.n) n, least squares over the surface."""
    normals = directions / np.linalg.norm(directions, axis=1)[:, None]
    first = normals @ E_XZ
    second = np.sum(first * normals, axis=1)[:, None] * normals
    weight = np.sqrt(frame[:, 7])[:, None]
    basis = np.stack([(weight * first).ravel(), (weight * second).ravel()], axis=1)
    return np.linalg.lstsq(basis, (weight * frame[:, 4:7]).ravel(), rcond=None)[0]


def measure_matrices(nodes, ratio, traction="lumped", box=18.0, accuracy=1e-5):
    """As compute_exact_matrices, from one evaluation in shear and four of small displacements."""
    still = make_flow("none", accuracy, traction)
    parts = [make_flow("shear xz 1.0", accuracy, traction)]
    for moduli in ("1.0 1.0", "1.0 11.0"):
        for a, b in ((AMPLITUDE, 0.0), (0.0, AMPLITUDE)):
            parts.append(f"angle_coeff 1 {moduli}\n" + DISPLACE.format(a=a, b=b) + still)
    surface = f"cells all viscosity/ratio {ratio}"
    frames, _ = run_frames("sphere radius 1", nodes, surface, parts, box)
    sphere = frames[0][:, 1:4]
    # The dump has the disturbance. Displacements count in units of the nodes' own radius.
    flow = fit_modes(frames[0], sphere) / np.linalg.norm(sphere, axis=1).mean() + [1.0, 0.0]
    both, more = (np.stack([fit_modes(f, sphere) for f in frames[k:k + 2]], axis=1) / AMPLITUDE
                  for k in (1, 3))
    dilatation = (more - both) / 10.0
    return both - dilatation, dilatation, flow


def measure_undeformed(shape, nodes, surface, box=18.0, accuracy=1e-5):
    """Rotation about y, stresslet xz, rms of the disturbance's deviation from a rigid motion in
    the shear of rate 1, and iterations: of a body without forces."""
    (frame,), (row,) = run_frames(shape, nodes, surface, [make_flow("shear xz 1.0", accuracy)], box)
    velocity = frame[:, 4:7] + np.outer(frame[:, 3], [1.0, 0.0, 0.0])
    deviation = velocity - np.cross([0.0, row["f_b[1][8]"], 0.0], frame[:, 1:4])
    rms = np.sqrt(np.average(np.sum(deviation ** 2, axis=1), weights=frame[:, 7]))
    return row["f_b[1][8]"], row["f_b[1][21]"], rms, row["f_b[11]"]


def compute_drop_stresslet(ratio):
    """Stresslet xz of a sphere without surface forces in the shear of rate 1, from u = 5 E.x /
    (2 lambda + 3) inside and S = (lambda - 1) int (u n + n u) dA."""
    return 40.0 * np.pi / 3.0 * (ratio - 1.0) / (2.0 * ratio + 3.0) * 0.5
