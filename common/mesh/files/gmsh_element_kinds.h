// The kinds of elements in Gmsh's files; for gmsh_reader.cpp.
#pragma once

namespace mortise::mesh {

struct GmshElementKind {
  int type;
  const char* name;
  int dimension;  // -1: cannot be used
  int nodes;
};

inline constexpr GmshElementKind kGmshElementKinds[] = {
    {15, "points", 0, 1},
    {1, "lines of 2 nodes", 1, 2},
    {8, "lines of 3 nodes", 1, 3},
    {2, "triangles of 3 nodes", 2, 3},
    {9, "triangles of 6 nodes", 2, 6},
    {4, "tetrahedra of 4 nodes", 3, 4},
    {11, "tetrahedra of 10 nodes", 3, 10},
    {3, "quadrangles of 4 nodes", -1, 0},
    {5, "hexahedra of 8 nodes", -1, 0},
    {6, "prisms of 6 nodes", -1, 0},
    {7, "pyramids of 5 nodes", -1, 0},
    {10, "quadrangles of 9 nodes", -1, 0},
    {12, "hexahedra of 27 nodes", -1, 0},
    {13, "prisms of 18 nodes", -1, 0},
    {14, "pyramids of 14 nodes", -1, 0},
    {16, "quadrangles of 8 nodes", -1, 0},
    {17, "hexahedra of 20 nodes", -1, 0},
    {18, "prisms of 15 nodes", -1, 0},
    {19, "pyramids of 13 nodes", -1, 0},
    {21, "triangles of 10 nodes", -1, 0},
    {29, "tetrahedra of 20 nodes", -1, 0},
};

}  // namespace mortise::mesh
