"""The layers of the package, read from its sources: nothing includes upward, the folder is flat,
the list of sources is the folder, files keep their size.  Knows no C++ beyond #include lines."""

import os
import re
import unittest
from pathlib import Path

REPOSITORY = Path(os.environ.get("BIEM_SOURCE", Path(__file__).resolve().parents[2]))
SOURCES = REPOSITORY / "src" / "USER-BIEM"

HARD_LIMIT = 500        # no file of code may be longer
FILE_BUDGET = 400
HEADER_BUDGET = 120
LINE_BUDGET = 100

ENTRY_POINTS = {"biem_main.cpp", "biemplugin.cpp", "biem_lammps_styles.h"}
STANDARD_OR_LIBRARY = re.compile(r"^(immintrin\.h|Eigen/.*|fftw3(-mpi)?\.h|mpi\.h|[a-z_0-9]+)$")
STYLE_GUARDS = re.compile(r"#ifdef +(ANGLE|DIHEDRAL|FIX|COMPUTE|COMMAND|PAIR)_CLASS")
STYLE_WORDS = re.compile(
    r"\b(ANGLE|ATOM|BODY|BOND|COMMAND|COMPUTE|DIHEDRAL|DUMP|FIX|IMPROPER|INTEGRATE|KSPACE|MINIMIZE"
    r"|NBIN|NPAIR|NSTENCIL|NTOPO|PAIR|READER|REGION)_CLASS\b")


def layer(path):
    """core, bridge, styles or entry: the layer of a file, from its name."""
    if path.name in ENTRY_POINTS:
        return "entry"
    if path.name.startswith("biem_lammps_"):
        return "bridge"
    return "core" if path.name.startswith("biem_") else "styles"


ALLOWED = {
    "core": {"core"},
    "bridge": {"core", "bridge"},
    "styles": {"core", "bridge", "styles"},
    "entry": {"core", "bridge", "styles", "entry"},
}


def code_files():
    return sorted(path for path in SOURCES.iterdir() if path.suffix in (".h", ".cpp"))


def includes(path):
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(), re.MULTILINE)


def listed_sources():
    """Kind of list (CORE, BRIDGE, ...) -> names, from the one CMake file that lists them."""
    text = (REPOSITORY / "cmake" / "biem_sources.cmake").read_text()
    lists = {}
    for kind, names in re.findall(r"set\(BIEM_(\w+)_SOURCES\s+([^)]*)\)", text):
        lists[kind] = names.split()
    return lists


class Layers(unittest.TestCase):
    def test_there_is_code_to_check(self):
        self.assertGreater(len(code_files()), 10, f"no code found in {SOURCES}")

    def test_no_upward_include(self):
        own = {path.name: layer(path) for path in code_files()}
        for path in code_files():
            for name in includes(path):
                if name in own:
                    self.assertIn(own[name], ALLOWED[layer(path)],
                                  f"{path.name} ({layer(path)}) includes {name} ({own[name]})")

    def test_core_includes_no_lammps_header(self):
        own = {path.name for path in code_files()}
        for path in code_files():
            if layer(path) != "core":
                continue
            for name in includes(path):
                self.assertTrue(name in own or STANDARD_OR_LIBRARY.match(name),
                                f"core file {path.name} includes {name}, which is neither the "
                                "core's own, nor standard, Eigen, FFTW or MPI")

    def test_core_headers_have_no_style_guard_words(self):
        # LAMMPS searches every header of a package folder for these words.
        for path in code_files():
            if path.suffix == ".h" and layer(path) != "styles":
                self.assertIsNone(STYLE_WORDS.search(path.read_text()), path.name)

    def test_core_neither_prints_nor_exits(self):
        words = re.compile(r"\b(std::cout|std::cerr|printf|fprintf|puts|exit|abort|MPI_Abort)\s*[(<]")
        for path in code_files():
            if layer(path) == "core":
                self.assertIsNone(words.search(path.read_text()), path.name)

    def test_style_headers_hide_core_types(self):
        # LAMMPS 29Sep2021 compiles style headers as C++11, where Eigen and the core may not.
        for path in code_files():
            if path.suffix == ".h" and STYLE_GUARDS.search(path.read_text()):
                for name in includes(path):
                    self.assertFalse(name.startswith("Eigen") or name.startswith("biem_"),
                                     f"style header {path.name} includes {name}")


class Folder(unittest.TestCase):
    def test_folder_is_flat(self):
        self.assertEqual([path.name for path in SOURCES.iterdir() if path.is_dir()], [])

    def test_list_of_sources_is_the_folder(self):
        listed = [name for names in listed_sources().values() for name in names]
        self.assertEqual(sorted(listed), sorted(set(listed)), "a source is listed twice")
        present = [path.name for path in code_files() if path.suffix == ".cpp"]
        self.assertEqual(sorted(listed), present)

    def test_list_of_sources_knows_the_layers(self):
        kinds = {"CORE": "core", "BRIDGE": "bridge", "STYLE": "styles",
                 "MAIN": "entry", "PLUGIN": "entry"}
        for kind, names in listed_sources().items():
            for name in names:
                self.assertEqual(layer(Path(name)), kinds[kind], f"{name} is listed as {kind}")

    def test_every_style_is_registered(self):
        registered = (SOURCES / "biem_lammps_styles.h").read_text()
        for path in code_files():
            if path.suffix != ".h":
                continue
            for name, style in re.findall(r"^\s*\w+Style\(([\w/]+), *(\w+)\)", path.read_text(),
                                          re.MULTILINE):
                self.assertIn(f'"{name}"', registered, f"{path.name}: style {name}")
                self.assertIn(style, registered, f"{path.name}: class {style}")


class Sizes(unittest.TestCase):
    def lengths(self):
        return {path.name: len(path.read_text().splitlines()) for path in code_files()}

    def test_no_file_passes_the_hard_limit(self):
        self.assertEqual({n: k for n, k in self.lengths().items() if k > HARD_LIMIT}, {})

    def test_files_and_headers_keep_their_budget(self):
        over = {n: k for n, k in self.lengths().items()
                if k > (HEADER_BUDGET if n.endswith(".h") else FILE_BUDGET)}
        self.assertEqual(over, {})

    def test_lines_keep_their_budget(self):
        long_lines = [f"{path.name}:{i}" for path in code_files()
                      for i, line in enumerate(path.read_text().splitlines(), 1)
                      if len(line) > LINE_BUDGET]
        self.assertEqual(long_lines, [])

    def test_every_file_begins_with_a_comment_or_a_guard(self):
        for path in code_files():
            first = path.read_text().lstrip()[:2]
            if not STYLE_GUARDS.match(path.read_text().lstrip()):
                self.assertIn(first, ("//", "/*"), f"{path.name} does not say what it is for")


if __name__ == "__main__":
    unittest.main()
