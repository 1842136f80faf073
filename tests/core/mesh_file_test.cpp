// Reading of OFF and STL: the same surface from all three formats, and the message for each fault.
#include "biem_error.h"
#include "biem_mesh_file.h"
#include "biem_mesh_shape.h"
#include "biem_mesh_topology.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

namespace biem {
namespace {

bool contains(const std::string &text, const std::string &part)
{
  return text.find(part) != std::string::npos;
}

// A file that goes away again.
class TemporaryFile {
 public:
  TemporaryFile(const std::string &content, const std::string &ending) :
      path_("mesh_file_test_" + std::to_string(getpid()) + ending)
  {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const std::string &path() const { return path_; }

 private:
  std::string path_;
};

SurfaceMesh read(const std::string &content, const std::string &ending)
{
  return read_surface_mesh(TemporaryFile(content, ending).path());
}

std::string message_of(const std::string &content, const std::string &ending)
{
  try {
    read(content, ending);
  } catch (const Error &error) {
    return error.what();
  }
  return "accepted";
}

std::string write_off(const SurfaceMesh &mesh)
{
  std::ostringstream out;
  out.precision(17);
  out << "OFF\n# a comment\n\n" << mesh.nodes.cols() << " " << mesh.triangles.size() << " 0\n";
  for (int i = 0; i < mesh.nodes.cols(); i++) out << mesh.nodes.col(i).transpose() << "\n";
  for (const Triangle &t : mesh.triangles)
    out << "3 " << t[0] << " " << t[1] << " " << t[2] << "  255 0 0  # colored\n";
  return out.str();
}

std::string write_text_stl(const SurfaceMesh &mesh)
{
  std::ostringstream out;
  out.precision(9);
  out << "solid ball made by a program\n";
  for (const Triangle &t : mesh.triangles) {
    out << "  facet normal 0 0 0\n    outer loop\n";
    for (int node : t) out << "      vertex " << mesh.nodes.col(node).transpose() << "\n";
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid ball\n";
  return out.str();
}

// Little-endian, as the format asks; the header is free text.
std::string write_binary_stl(const SurfaceMesh &mesh, const std::string &title)
{
  std::string out = title + std::string(80 - title.size(), ' ');
  auto add = [&](std::uint32_t bits, int n_bytes) {
    for (int k = 0; k < n_bytes; k++) out += static_cast<char>(bits >> (8 * k) & 255);
  };
  add(static_cast<std::uint32_t>(mesh.triangles.size()), 4);
  for (const Triangle &t : mesh.triangles) {
    for (int k = 0; k < 3; k++) add(0, 4);
    for (int node : t)
      for (int c = 0; c < 3; c++) {
        const float value = static_cast<float>(mesh.nodes(c, node));
        std::uint32_t bits;
        std::memcpy(&bits, &value, 4);
        add(bits, 4);
      }
    add(0, 2);
  }
  return out;
}

// Nodes may be numbered otherwise: compares triangle by triangle.
void expect_same_surface(const SurfaceMesh &one, const SurfaceMesh &other, double tolerance)
{
  ASSERT_EQ(one.nodes.cols(), other.nodes.cols());
  ASSERT_EQ(one.triangles.size(), other.triangles.size());
  for (std::size_t i = 0; i < one.triangles.size(); i++)
    for (int k = 0; k < 3; k++)
      EXPECT_LE((one.nodes.col(one.triangles[i][k]) - other.nodes.col(other.triangles[i][k]))
                    .cwiseAbs().maxCoeff(), tolerance);
}

TEST(MeshFile, ThreeFormatsGiveTheSameClosedSurface)
{
  const SurfaceMesh mesh = make_mesh(*make_red_cell(1.5), 162);
  expect_same_surface(read(write_off(mesh), ".off"), mesh, 0.0);
  expect_same_surface(read(write_text_stl(mesh), ".stl"), mesh, 1e-8);
  expect_same_surface(read(write_binary_stl(mesh, "exported"), ".stl"), mesh, 1.2e-7);
  // a binary file may begin like a text file, and the name does not decide
  expect_same_surface(read(write_binary_stl(mesh, "solid"), ".dat"), mesh, 1.2e-7);
  for (const std::string &content :
       {write_off(mesh), write_text_stl(mesh), write_binary_stl(mesh, "")}) {
    const SurfaceMesh again = read(content, ".mesh");
    EXPECT_NO_THROW(check_closed_oriented(again.nodes, again.triangles));
  }
}

TEST(MeshFile, OffMayHaveTheCountsBesideTheWordAndWindowsLines)
{
  const SurfaceMesh mesh =
      read("OFF 4 2 5\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n1 1 0\r\n3 0 1 2\r\n3 1 3 2\r\n", ".off");
  EXPECT_EQ(mesh.nodes.cols(), 4);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(MeshFile, MinusZeroIsZero)
{
  const std::string text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
      "vertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex -0 0 -0.0\n"
      "vertex 0 1 0\nvertex -1 0 0\nendloop\nendfacet\nendsolid\n";
  EXPECT_EQ(read(text, ".stl").nodes.cols(), 4);
}

TEST(MeshFile, FaultsOfOffFilesAreNamedWithTheirLine)
{
  const std::string nodes = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  for (const auto &fault : std::vector<std::array<std::string, 2>>{
           {"", "the file is empty"},
           {"PLY\n", "unknown format"},
           {"OFF\n", "line 1: the file ends where the numbers of nodes and faces should follow"},
           {"OFF\n4\n", "line 2: the numbers of nodes and faces are missing"},
           {"OFF\n2 1 0\n", "line 2: 2 nodes and 1 faces make no surface"},
           {"OFF\n4 2 0\n0 0 0\n1 0\n", "line 4: a node has three coordinates, but there are 2"},
           {"OFF\n4 2 0\n0 0 0\n1 0 x\n", "line 4: 'x' is not a number"},
           {"OFF\n4 2 0\n0 0 0\n1 0 nan\n", "line 4: 'nan' is not a finite number"},
           {"OFF\n4 2 0\n0 0 0\n1 0 0\n", "line 4: the file ends where node 3 of 4 should follow"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n", "line 7: the file ends where face 2 of 2"},
           {"OFF\n4 1 0\n" + nodes + "4 0 1 3 2\n", "line 7: a face of 4 corners"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n3 1 3 4\n", "line 8: node 4 does not exist"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n3 1 3\n", "line 8: a triangle needs three nodes"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n3 1 3.5 2\n", "line 8: '3.5' is not an integer"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n3 1 3 3\n", "line 8: a degenerate triangle"},
           {"OFF\n4 1 0\n" + nodes + "3 0 1 2\n", "line 6: the node belongs to no triangle"},
           {"OFF\n4 2 0\n" + nodes + "3 0 1 2\n3 1 3 2\n3 0 1 3\n", "line 9: there is more than"},
           {"OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", "line 6: a degenerate triangle"}})
    EXPECT_TRUE(contains(message_of(fault[0], ".off"), fault[1]))
        << fault[1] << "\n" << message_of(fault[0], ".off");
  EXPECT_TRUE(contains(message_of("", ".off"), "mesh_file_test_")) << "names the file";
}

TEST(MeshFile, FaultsOfTextStlAreNamedWithTheirLine)
{
  const std::string begin = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const std::string end = "endloop\nendfacet\nendsolid a\n";
  for (const auto &fault : std::vector<std::array<std::string, 2>>{
           {"solid a\nendsolid a\n", "there are no triangles"},
           {"solid a\n", "line 1: the file ends before 'endsolid'"},
           {begin, "line 5: the file ends where 'vertex' should follow"},
           {begin + "vertex 0 1 0\nendloop\nendfacet\n", "the file ends before 'endsolid'"},
           {begin + "vertex 0 1\n" + end, "line 6: a vertex has three coordinates"},
           {begin + "vertex 0 1 inf\n" + end, "line 6: 'inf' is not a finite number"},
           {begin + end, "line 6: 'endloop' where 'vertex' is expected"},
           {begin + "vertex 1 1 0\nvertex 0 1 0\n" + end, "line 7: a facet of more than three"},
           {begin + "vertex 1 0 0\n" + end, "facet at line 2: a degenerate triangle"},
           {begin + "vertex 0 1 0\nendloop\nendfacet\nedge\n", "line 9: 'edge' where 'facet'"},
           {begin + "vertex 0 1 0\n" + end + "facet\n", "line 10: 'facet' where 'solid'"}})
    EXPECT_TRUE(contains(message_of(fault[0], ".stl"), fault[1]))
        << fault[1] << "\n" << message_of(fault[0], ".stl");
}

TEST(MeshFile, FaultsOfBinaryStlAreNamed)
{
  SurfaceMesh mesh = make_icosphere(1);
  const std::string whole = write_binary_stl(mesh, "");
  EXPECT_TRUE(contains(message_of(whole.substr(0, 700), ".stl"),
                       "of 20 triangles it must have 1084 bytes, but it has 700"));
  EXPECT_TRUE(contains(message_of(whole.substr(0, 60), ".stl"), "is it truncated?"));
  EXPECT_TRUE(contains(message_of(whole + "x", ".stl"), "but it has 1085"));
  mesh.nodes(1, mesh.triangles[3][0]) = std::nan("");
  EXPECT_TRUE(contains(message_of(write_binary_stl(mesh, ""), ".stl"), "not a finite number"));
  mesh = make_icosphere(1);
  mesh.nodes.col(mesh.triangles[0][1]) = mesh.nodes.col(mesh.triangles[0][0]);
  EXPECT_TRUE(contains(message_of(write_binary_stl(mesh, ""), ".stl"),
                       "triangle 1: a degenerate triangle"));
}

TEST(MeshFile, AMissingFileIsNamed)
{
  try {
    read_surface_mesh("no/such/mesh.stl");
    FAIL();
  } catch (const Error &error) {
    EXPECT_TRUE(contains(error.what(), "Mesh file no/such/mesh.stl: cannot be opened"));
  }
}

}    // namespace
}    // namespace biem
