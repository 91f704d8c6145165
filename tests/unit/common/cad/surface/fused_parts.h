// Solids to fuse, and what is to hold of them fused.
#pragma once

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Eigen/Geometry>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/mesher.h"

namespace mortise::cad {

inline Solid Named(const TopoDS_Shape& shape, const std::string& name) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(kernel->shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    kernel->faces.push_back(TopoDS::Face(faces(i)));
    kernel->face_names.push_back(absl::StrCat("face", i));
  }
  return Solid(std::move(kernel));
}

inline TopoDS_Shape BoxAt(double x, double y, double z, double dx, double dy, double dz) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), dx, dy, dz).Solid();
}

inline TopoDS_Shape Upright(double x, double y, double from, double to, double radius) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, from), gp_Dir(0, 0, 1)), radius, to - from)
      .Solid();
}

// A seat of 400 × 400 × 30 mm on z = 0.4 with a bore through it.
inline constexpr double kBore = 0.016;
inline TopoDS_Shape BoredSeat(double bore = kBore) {
  return BRepAlgoAPI_Cut(BoxAt(0, 0, 0.4, 0.4, 0.4, 0.03), Upright(0.1, 0.1, 0.3, 0.5, bore))
      .Shape();
}

struct Interface {
  int faces = 0;
  double area = 0;  // m²
};

inline Interface Between(const mesh::AssemblySurface& surface, int first, int second) {
  Interface found;
  for (const mesh::AssemblyFace& face : surface.faces) {
    found.faces += std::minmax(face.back_part, face.front_part) == std::minmax(first, second);
  }
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        surface.faces[static_cast<std::size_t>(surface.triangle_face(t))];
    if (std::minmax(face.back_part, face.front_part) != std::minmax(first, second)) continue;
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    found.area += (b - a).cross(surface.vertices.col(surface.triangles(2, t)) - a).norm() / 2;
  }
  return found;
}

inline double VolumeOf(const mesh::AssemblySurface& surface, int part) {
  return mesh::ComputeMassProperties(mesh::PartSurface(surface, part)).volume;
}

// Sound, and every part has its volume but for what chords cut off curved faces.
inline void ExpectSound(const mesh::AssemblySurface& surface, const std::vector<Solid>& parts,
                        double slack) {
  EXPECT_EQ(mesh::CheckAssembly(surface), absl::OkStatus());
  EXPECT_TRUE(mesh::FindIntersections(surface.vertices, surface.triangles).empty());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double exact = parts[i].Volume();
    EXPECT_NEAR(VolumeOf(surface, static_cast<int>(i)), exact, slack * exact) << parts[i].name();
  }
  mesh::MeshOptions options;
  options.quadratic = false;
  const auto meshed = mesh::MeshAssembly(surface, options);
  EXPECT_TRUE(meshed.ok()) << meshed.status();
}

}  // namespace mortise::cad
