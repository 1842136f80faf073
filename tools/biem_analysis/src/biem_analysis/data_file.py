"""Reads LAMMPS data files of any content; hands MDAnalysis the sections that it understands.

The parser of MDAnalysis takes the lines of a section it does not know for lines of the section
before it, and 'Angle Coeffs' for triangles. So every other section is removed first.
"""

import os
import re

import numpy as np

from .errors import BiemAnalysisError

TOPOLOGY_SECTIONS = ("Masses", "Atoms", "Bonds", "Angles", "Dihedrals")
ATOM_COLUMNS = {
    "molecular": "id resid type x y z",
    "bond": "id resid type x y z",
    "angle": "id resid type x y z",
    "full": "id resid type charge x y z",
}
STYLE_OF_COLUMN_COUNT = {6: "molecular", 9: "molecular", 7: "full", 10: "full"}


def read_text(path):
    """The text of a file; a readable error where there is none."""
    if not os.path.isfile(path):
        raise BiemAnalysisError(
            f"data file '{path}' does not exist; write it in LAMMPS with "
            "'write_data cells.data nocoeff nofix'")
    with open(path, encoding="utf-8", errors="replace") as stream:
        return stream.read()


def split_sections(path):
    """Header text and a dict {section title line: body text} of a LAMMPS data file.

    A section starts at a line that begins with a letter or underscore: header and data lines
    begin with a number or blank.  The very first line is a free comment and is dropped.
    """
    _, _, text = read_text(path).partition("\n")
    parts = re.split(r"(?m)^(?=[A-Za-z_])", text)
    sections = {}
    for part in parts[1:]:
        title, _, body = part.partition("\n")
        sections[title.strip()] = body
    return parts[0], sections


def find_section(sections, name):
    """Title line of the section called exactly `name` ('Atoms # molecular' counts), or None."""
    for title in sections:
        if title.partition("#")[0].strip() == name:
            return title
    return None


def find_atom_style(path, title, body):
    """The LAMMPS atom style of the Atoms section, from its title or else its column count."""
    style = title.partition("#")[2].strip()
    if not style:
        first = next((line for line in body.splitlines() if line.strip()), "")
        style = STYLE_OF_COLUMN_COUNT.get(len(first.partition("#")[0].split()), "unknown")
    if style not in ATOM_COLUMNS:
        raise BiemAnalysisError(
            f"data file '{path}' has atom style '{style}', which does not give molecule ids in a "
            f"known column; use one of {', '.join(ATOM_COLUMNS)}")
    return style


def extract_topology(path):
    """The part of a data file that MDAnalysis reads.

    Returns
    -------
    text : str
        header and topology sections
    atom_columns : str
        the column description that MDAnalysis calls `atom_style`
    """
    header, sections = split_sections(path)
    atoms = find_section(sections, "Atoms")
    if atoms is None:
        raise BiemAnalysisError(
            f"'{path}' has no 'Atoms' section, so it is not a LAMMPS data file; write one with "
            "'write_data cells.data nocoeff nofix'")
    angles = find_section(sections, "Angles")
    if angles is None or not sections[angles].strip():
        raise BiemAnalysisError(
            f"data file '{path}' has no triangles (no 'Angles' section), so it holds no cells; "
            "write it after create_cells, with atom_style molecular or another one with angles")
    style = find_atom_style(path, atoms, sections[atoms])
    kept = ["LAMMPS data file\n", header]
    for name in TOPOLOGY_SECTIONS:
        title = find_section(sections, name)
        if title is not None and sections[title].strip():
            kept += [name, "\n", sections[title].rstrip(), "\n\n"]
    return "".join(kept), ATOM_COLUMNS[style]


def read_reference_shape(path, ids, section="biem_reference"):
    """The reference shape that `fix biem_reference all property/atom ...` writes to a data file.

    Parameters
    ----------
    path : str
        data file written without the option `nofix`
    ids : array of int, shape (n_atoms,)
        LAMMPS atom ids, in the order wanted

    Returns
    -------
    array of float, shape (n_atoms, 3), length; zero for atoms that have no reference shape
    """
    _, sections = split_sections(path)
    title = find_section(sections, section)
    if title is None:
        raise BiemAnalysisError(
            f"data file '{path}' has no section '{section}' with the reference shape; write it "
            "with 'write_data cells.data nocoeff' (without nofix), or use the first frame")
    rows = np.array([line.partition("#")[0].split()[:4]
                     for line in sections[title].splitlines() if line.strip()], dtype=float)
    row_of_id = {int(row[0]): row[1:4] for row in rows}
    return np.array([row_of_id.get(int(i), np.zeros(3)) for i in ids])
