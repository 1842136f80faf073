// Three readers that end in one place: nodes, triangles, and where each triangle came from.
// Does not know units, boxes or surfaces.
#include "biem_mesh_file.h"

#include "biem_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>

namespace biem {
namespace {

constexpr std::size_t stl_header_size = 84, stl_record_size = 50;    // bytes

class MeshFile {
 public:
  explicit MeshFile(const std::string &path) : path_(path)
  {
    std::ifstream file(path, std::ios::binary);
    if (!file)
      throw Error("Mesh file " + path + ": cannot be opened; is the name right, also seen from "
                  "the folder in which the program runs?");
    content_.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    if (file.bad()) throw Error("Mesh file " + path + ": cannot be read; is it a folder?");
  }

  SurfaceMesh read()
  {
    // Binary files may begin with the word "solid", too: the size decides.
    if (is_binary_stl())
      read_binary_stl();
    else if (get_first_word() == "solid")
      read_text_stl();
    else if (get_first_word() == "OFF")
      read_off();
    else
      fail_format();
    return make_mesh();
  }

 private:
  [[noreturn]] void fail(const std::string &where, const std::string &what) const
  {
    throw Error("Mesh file " + path_ + (where.empty() ? "" : ", " + where) + ": " + what);
  }
  static std::string name_line(int line) { return "line " + std::to_string(line); }

  std::string get_first_word() const
  {
    std::istringstream stream(content_.substr(0, 256));
    std::string word;
    stream >> word;
    return word;
  }

  std::uint32_t get_binary_count() const
  {
    unsigned char bytes[4];
    std::memcpy(bytes, content_.data() + stl_header_size - 4, 4);
    return bytes[0] | bytes[1] << 8 | bytes[2] << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
  }
  std::size_t get_binary_size() const
  {
    return stl_header_size + stl_record_size * get_binary_count();
  }
  bool is_binary_stl() const
  {
    return content_.size() >= stl_header_size && content_.size() == get_binary_size() &&
        get_binary_count() > 0;
  }

  [[noreturn]] void fail_format() const
  {
    if (content_.empty()) fail("", "the file is empty");
    const bool is_named_stl = path_.size() > 4 &&
        (path_.substr(path_.size() - 4) == ".stl" || path_.substr(path_.size() - 4) == ".STL");
    if (is_named_stl && content_.size() >= stl_header_size)
      fail("", "as a binary STL file of " + std::to_string(get_binary_count()) +
           " triangles it must have " + std::to_string(get_binary_size()) + " bytes, but it has " +
           std::to_string(content_.size()) + "; is it truncated? Text files begin with 'solid'");
    if (is_named_stl)
      fail("", "an STL file begins with 'solid' or has at least 84 bytes; is it truncated?");
    fail("", "unknown format; it must be OFF (the first word is OFF) or STL (text or binary)");
  }

  double parse_number(const std::string &word, const std::string &where) const
  {
    char *end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (word.empty() || *end != '\0') fail(where, "'" + word + "' is not a number");
    if (!std::isfinite(value)) fail(where, "'" + word + "' is not a finite number");
    return value;
  }

  int parse_integer(const std::string &word, const std::string &where) const
  {
    const double value = parse_number(word, where);
    if (value != std::floor(value) || std::abs(value) > 1e9)
      fail(where, "'" + word + "' is not an integer in the range that is needed");
    return static_cast<int>(value);
  }

  // Words of the next line that is not empty; '#' begins a comment. False at the end of the file.
  bool read_line(std::vector<std::string> &words)
  {
    words.clear();
    while (words.empty() && position_ < content_.size()) {
      const std::size_t end = std::min(content_.find('\n', position_), content_.size());
      std::string text = content_.substr(position_, end - position_);
      position_ = end + 1;
      line_++;
      std::istringstream stream(text.substr(0, text.find('#')));
      for (std::string word; stream >> word;) words.push_back(word);
    }
    return !words.empty();
  }

  void require_line(std::vector<std::string> &words, const std::string &what)
  {
    if (!read_line(words))
      fail(name_line(line_), "the file ends where " + what + " should follow; is it truncated?");
  }

  void read_off();
  void read_off_face(int face, int n_faces, int n_nodes);
  void read_text_stl();
  void read_text_facet();
  void read_binary_stl();
  int find_or_add_node(const Vec3 &place);
  SurfaceMesh make_mesh() const;
  void check_triangle(std::size_t i) const;

  std::string path_, content_;
  std::size_t position_ = 0;
  int line_ = 0;
  std::vector<Vec3> nodes_;
  std::vector<std::string> place_of_node_, place_of_triangle_;
  std::vector<Triangle> triangles_;
  std::map<std::array<double, 3>, int> node_at_;
};

void MeshFile::read_off()
{
  std::vector<std::string> words;
  require_line(words, "the word OFF");
  words.erase(words.begin());    // the counts may follow OFF on its line
  if (words.empty()) require_line(words, "the numbers of nodes and faces");
  if (words.size() < 2) fail(name_line(line_), "the numbers of nodes and faces are missing");
  const int n_nodes = parse_integer(words[0], name_line(line_));
  const int n_faces = parse_integer(words[1], name_line(line_));
  if (n_nodes < 3 || n_faces < 1)
    fail(name_line(line_), std::to_string(n_nodes) + " nodes and " + std::to_string(n_faces) +
         " faces make no surface");
  for (int i = 0; i < n_nodes; i++) {
    require_line(words, "node " + std::to_string(i + 1) + " of " + std::to_string(n_nodes));
    const std::string where = name_line(line_);
    if (words.size() != 3)
      fail(where, "a node has three coordinates, but there are " + std::to_string(words.size()) +
           " words; are the numbers of nodes and faces in the header right?");
    nodes_.emplace_back(parse_number(words[0], where), parse_number(words[1], where),
                        parse_number(words[2], where));
    place_of_node_.push_back(where);
  }
  for (int i = 0; i < n_faces; i++) read_off_face(i, n_faces, n_nodes);
  if (read_line(words))
    fail(name_line(line_), "there is more than the " + std::to_string(n_faces) +
         " faces that the header announces");
}

void MeshFile::read_off_face(int face, int n_faces, int n_nodes)
{
  std::vector<std::string> words;
  require_line(words, "face " + std::to_string(face + 1) + " of " + std::to_string(n_faces));
  const std::string where = name_line(line_);
  const int n_corners = parse_integer(words[0], where);
  if (n_corners != 3)
    fail(where, "a face of " + std::to_string(n_corners) +
         " corners; all faces must be triangles: triangulate the mesh");
  if (words.size() < 4) fail(where, "a triangle needs three nodes");
  Triangle t;
  for (int k = 0; k < 3; k++) {
    t[k] = parse_integer(words[k + 1], where);
    if (t[k] < 0 || t[k] >= n_nodes)
      fail(where, "node " + words[k + 1] + " does not exist; nodes count from 0 to " +
           std::to_string(n_nodes - 1));
  }
  triangles_.push_back(t);
  place_of_triangle_.push_back(where);
}

void MeshFile::read_text_stl()
{
  std::vector<std::string> words;
  bool is_in_solid = false;
  while (read_line(words)) {
    if (!is_in_solid && words[0] == "solid") {
      is_in_solid = true;
    } else if (is_in_solid && words[0] == "endsolid") {
      is_in_solid = false;
    } else if (is_in_solid && words[0] == "facet") {
      read_text_facet();
    } else {
      fail(name_line(line_), "'" + words[0] + "' where " +
           (is_in_solid ? "'facet' or 'endsolid'" : "'solid'") + " is expected");
    }
  }
  if (is_in_solid)
    fail(name_line(line_), "the file ends before 'endsolid'; is it truncated?");
}

void MeshFile::read_text_facet()
{
  const std::string where = name_line(line_);
  std::vector<std::string> words;
  auto require = [&](const std::string &what) {
    require_line(words, "'" + what + "'");
    if (words[0] == "vertex" && what == "endloop")
      fail(name_line(line_), "a facet of more than three corners; all must be triangles: "
           "triangulate the mesh");
    if (words[0] != what)
      fail(name_line(line_), "'" + words[0] + "' where '" + what + "' is expected");
  };
  require("outer");
  Triangle t;
  for (int k = 0; k < 3; k++) {
    require("vertex");
    if (words.size() != 4) fail(name_line(line_), "a vertex has three coordinates");
    Vec3 place;
    for (int c = 0; c < 3; c++) place[c] = parse_number(words[c + 1], name_line(line_));
    t[k] = find_or_add_node(place);
  }
  require("endloop");
  require("endfacet");
  triangles_.push_back(t);
  place_of_triangle_.push_back("facet at " + where);
}

void MeshFile::read_binary_stl()
{
  static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == 4, "IEEE 754 numbers");
  for (std::uint32_t i = 0; i < get_binary_count(); i++) {
    const std::string where = "triangle " + std::to_string(i + 1);
    Triangle t;
    for (int k = 0; k < 3; k++) {
      Vec3 place;
      for (int c = 0; c < 3; c++) {
        unsigned char b[4];    // least significant byte first, whatever the machine
        std::memcpy(b, content_.data() + stl_header_size + stl_record_size * i + 12 + 12 * k +
                    4 * c, 4);
        const std::uint32_t bits =
            b[0] | b[1] << 8 | b[2] << 16 | static_cast<std::uint32_t>(b[3]) << 24;
        float value;
        std::memcpy(&value, &bits, 4);
        if (!std::isfinite(value)) fail(where, "a coordinate is not a finite number");
        place[c] = value;
      }
      t[k] = find_or_add_node(place);
    }
    triangles_.push_back(t);
    place_of_triangle_.push_back(where);
  }
}

int MeshFile::find_or_add_node(const Vec3 &place)
{
  const int next = static_cast<int>(nodes_.size());
  // adding 0 makes +0 of -0
  const auto found = node_at_.insert({{place[0] + 0.0, place[1] + 0.0, place[2] + 0.0}, next});
  if (found.second) nodes_.push_back(place);
  return found.first->second;
}

void MeshFile::check_triangle(std::size_t i) const
{
  const Triangle &t = triangles_[i];
  const Vec3 ab = nodes_[t[1]] - nodes_[t[0]], ac = nodes_[t[2]] - nodes_[t[0]];
  const Vec3 bc = ac - ab;
  const double longest =
      std::max(ab.squaredNorm(), std::max(ac.squaredNorm(), bc.squaredNorm()));
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || ab.cross(ac).norm() <= 1e-10 * longest)
    fail(place_of_triangle_[i], "a degenerate triangle: its corners coincide or lie on a line; "
         "repair the mesh");
}

SurfaceMesh MeshFile::make_mesh() const
{
  if (triangles_.empty()) fail("", "there are no triangles");
  std::vector<char> is_used(nodes_.size(), 0);
  for (std::size_t i = 0; i < triangles_.size(); i++) {
    check_triangle(i);
    for (int node : triangles_[i]) is_used[node] = 1;
  }
  const auto unused = std::find(is_used.begin(), is_used.end(), 0) - is_used.begin();
  if (unused < static_cast<std::ptrdiff_t>(nodes_.size()))
    fail(place_of_node_[unused], "the node belongs to no triangle; remove it");
  SurfaceMesh mesh;
  mesh.nodes.resize(3, nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); i++) mesh.nodes.col(i) = nodes_[i];
  mesh.triangles = triangles_;
  return mesh;
}

}    // namespace

SurfaceMesh read_surface_mesh(const std::string &path)
{
  return MeshFile(path).read();
}

}    // namespace biem
