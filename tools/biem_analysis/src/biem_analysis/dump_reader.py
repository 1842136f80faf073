"""Reads text dumps of LAMMPS frame by frame, in double precision and with the exact box.

Knows no cells.  It replaces the dump reader of MDAnalysis because that one keeps positions in
single precision only: after a long shear an unwrapped coordinate of 1e4 would be known to 1e-3.
MDAnalysis' own positions stay single precision; the exact ones are in `Timestep.data`.
"""

import mmap
import os
import warnings

import numpy as np
from MDAnalysis.coordinates import base
from MDAnalysis.lib.mdamath import triclinic_box
from MDAnalysis.lib.util import store_init_arguments

from .errors import BiemAnalysisError

FRAME_START = b"ITEM: TIMESTEP"
ADVICE = ("dump ID all custom N cells.dump id mol type xu yu zu vx vy vz  and  "
          "dump_modify ID sort id format float %.12g")


def find_frames(path):
    """Byte ranges (begin, end) of the frames of a dump; an unfinished last one is left out."""
    if not os.path.isfile(path):
        raise BiemAnalysisError(f"dump file '{path}' does not exist; write one with: {ADVICE}")
    if os.path.getsize(path) == 0:
        raise BiemAnalysisError(f"dump file '{path}' is empty; let the run write a frame first")
    with open(path, "rb") as stream, \
            mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as text:
        begins = []
        position = text.find(FRAME_START)
        while position >= 0:
            begins.append(position)
            position = text.find(FRAME_START, position + len(FRAME_START))
        frames = list(zip(begins, begins[1:] + [len(text)]))
        if not frames:
            raise BiemAnalysisError(
                f"'{path}' is not a text dump of LAMMPS: it has no line 'ITEM: TIMESTEP'; "
                f"write one with: {ADVICE}")
        if not is_complete(text[slice(*frames[-1])]):
            frames.pop()
            warnings.warn(f"the last frame of '{path}' is not complete and is left out")
    if not frames:
        raise BiemAnalysisError(f"dump file '{path}' has no complete frame; wait for the run")
    return frames


def is_complete(frame):
    """Whether the bytes of a frame hold as many atom lines as its header announces."""
    lines = frame.split(b"\n")
    if len(lines) < 10 or not lines[3].strip().isdigit():
        return False
    return len(lines) > 9 + int(lines[3])    # the last atom line ends with a newline


def parse_box(title, lines):
    """Box of a frame from its 'ITEM: BOX BOUNDS' line and the three lines after it.

    A triclinic dump gives the bounds of the tilted box's bounding box (LAMMPS Howto_triclinic).

    Returns
    -------
    matrix : array (3, 3), rows = edge vectors, length
    origin : array (3,), lower corner, length
    """
    rows = [[float(word) for word in line.split()] for line in lines]
    low, high = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    xy = xz = yz = 0.0
    words = title.split()[3:]
    if words[:3] == [b"xy", b"xz", b"yz"]:
        xy, xz, yz = (row[2] for row in rows)
    elif b"abc" in words:
        raise BiemAnalysisError("the dump was written with 'triclinic/general yes'; write it "
                                "without, as restricted triclinic box")
    low[0] -= min(0.0, xy, xz, xy + xz)
    high[0] -= max(0.0, xy, xz, xy + xz)
    low[1] -= min(0.0, yz)
    high[1] -= max(0.0, yz)
    length = high - low
    return np.array([[length[0], 0, 0], [xy, length[1], 0], [xz, yz, length[2]]]), low


class BiemDumpReader(base.ReaderBase):
    """MDAnalysis reader of `dump custom` with unwrapped positions xu yu zu.

    Positions are LAMMPS coordinates (not shifted to a box origin of zero), sorted by atom id.
    A flip of the tilt leaves them continuous: LAMMPS renumbers the images together with the box.

    Parameters
    ----------
    filename : str
    timestep : float
        time step of the run, time; the time of a frame is its step number times this

    `ts.data` holds
        step : int;  time : float;  ids : array (n_atoms,)
        positions : float64 array (n_atoms, 3);  box : array (3, 3);  origin : array (3,)
    """

    format = "BIEMDUMP"
    units = {"time": None, "length": None}

    @store_init_arguments
    def __init__(self, filename, timestep=1.0, **kwargs):
        super().__init__(filename, convert_units=False, **kwargs)
        self._timestep = timestep
        self._frames = find_frames(self.filename)
        self._file = open(self.filename, "rb")
        self._ids = None
        self._file.seek(self._frames[0][0])
        try:
            self.n_atoms = int([self._file.readline() for _ in range(4)][3])
        except ValueError:
            raise BiemAnalysisError(f"the dump '{self.filename}' does not give the number of atoms "
                                    f"in its fourth line; write it with: {ADVICE}") from None
        self.ts = self._Timestep(self.n_atoms, **self._ts_kwargs)
        self.ts.frame = -1
        self._read_next_timestep()

    @property
    def n_frames(self):
        """Number of complete frames in the file."""
        return len(self._frames)

    @property
    def ids(self):
        """LAMMPS atom ids in the order of the positions, shape (n_atoms,)."""
        return self._ids

    def close(self):
        """Close the file."""
        if hasattr(self, "_file"):
            self._file.close()

    def _reopen(self):
        self.close()
        self._file = open(self.filename, "rb")
        self.ts.frame = -1

    def _read_frame(self, frame):
        self.ts.frame = frame - 1
        return self._read_next_timestep()

    def _read_next_timestep(self, ts=None):
        ts = self.ts if ts is None else ts
        if ts.frame + 1 >= self.n_frames:
            raise EOFError
        ts.frame += 1
        begin, end = self._frames[ts.frame]
        self._file.seek(begin)
        try:
            lines = self._file.read(end - begin).split(b"\n", 9)
            step, n_atoms = int(lines[1]), int(lines[3])
            box, origin = parse_box(lines[4], lines[5:8])
            names = lines[8].split()[2:]
        except (ValueError, IndexError) as error:
            raise BiemAnalysisError(f"the dump '{self.filename}' is damaged in the header of frame "
                                    f"{ts.frame}: {error}; write it again") from None
        if n_atoms != self.n_atoms:
            raise BiemAnalysisError(
                f"the dump '{self.filename}' has {n_atoms} atoms at step {step}, but "
                f"{self.n_atoms} in its first frame; the number of atoms must not change")
        self._fill(ts, self._parse_columns(step, names, lines[9]))
        ts.dimensions = triclinic_box(*box)
        ts.data.update(step=step, time=step * self._timestep, box=box, origin=origin)
        return ts

    def _parse_columns(self, step, names, body):
        """Dict {column name: float array (n_atoms,)} of id, positions and velocities."""
        names = [name.decode() for name in names]
        missing = [name for name in ("id", "xu", "yu", "zu") if name not in names]
        if missing:
            raise BiemAnalysisError(
                f"the dump '{self.filename}' lacks the column(s) {' '.join(missing)}; it has "
                f"'{' '.join(names)}'; write it with: {ADVICE}")
        words = body.split(None, self.n_atoms * len(names))[:self.n_atoms * len(names)]
        if len(words) < self.n_atoms * len(names):
            raise BiemAnalysisError(
                f"the dump '{self.filename}' is damaged: step {step} has {len(words)} values "
                f"instead of {self.n_atoms} x {len(names)}")
        wanted = ["id", "xu", "yu", "zu"]
        if {"vx", "vy", "vz"} <= set(names):
            wanted += ["vx", "vy", "vz"]
        try:
            columns = {name: np.array(words[names.index(name)::len(names)], dtype=float)
                       for name in wanted}
        except ValueError as error:
            raise BiemAnalysisError(
                f"the dump '{self.filename}' is damaged at step {step}: {error}") from None
        for name in wanted:
            if not np.all(np.isfinite(columns[name])):
                raise BiemAnalysisError(
                    f"the dump '{self.filename}' has a value in column {name} at step {step} that "
                    "is not a finite number; the run has failed before this step")
        return columns

    def _fill(self, ts, columns):
        ids = columns["id"].astype(np.int64)
        order = np.argsort(ids)
        if self._ids is None:
            self._ids = ids[order]
        if not np.array_equal(ids[order], self._ids):
            raise BiemAnalysisError(
                f"the atoms of the dump '{self.filename}' change at frame {ts.frame}: other ids "
                "than in the first frame")
        positions = np.column_stack([columns[name] for name in ("xu", "yu", "zu")])[order]
        ts.positions = positions
        ts.data.update(positions=positions, ids=self._ids)
        if "vx" in columns:
            ts.has_velocities = True
            ts.velocities = np.column_stack([columns[name] for name in ("vx", "vy", "vz")])[order]
