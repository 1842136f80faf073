// Triangle meshes from files: OFF, and STL as text or binary. Knows formats; not what a mesh is
// used for nor whether it is closed.
#ifndef BIEM_MESH_FILE_H
#define BIEM_MESH_FILE_H

#include "biem_mesh_icosphere.h"

#include <string>

namespace biem {

// The format is found from the content. Nodes in the units of the file, in the order in which they
// first appear. STL: corners of equal coordinates become one node; normals in the file are ignored,
// the order of the corners counts (counter-clockwise seen from outside). OFF: what follows the
// three corners of a face (colors) is ignored. Error with file, line (or triangle) and cause: not
// readable, no such format, truncated, not a number, not triangles, degenerate, unused nodes.
SurfaceMesh read_surface_mesh(const std::string &path);

}    // namespace biem

#endif
