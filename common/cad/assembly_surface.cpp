// Fuses the parts' solids with Open CASCADE's general fuse and triangulates each piece once.
#include "common/cad/assembly_surface.h"

#include <BOPAlgo_Builder.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/interior_point.h"
#include "common/cad/point_merger.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kFuseTolerance = 1e-6;   // m; faces nearer than this are one
constexpr double kMergeTolerance = 1e-6;  // m; points nearer than this are one
constexpr double kDeflection = 1e-3;      // m; chord height where faces are curved

// The pieces a shape was split into; itself if it was left whole.
TopTools_ListOfShape PiecesOf(BOPAlgo_Builder& fuse, const TopoDS_Shape& shape) {
  TopTools_ListOfShape pieces = fuse.Modified(shape);
  if (pieces.IsEmpty() && !fuse.IsDeleted(shape)) pieces.Append(shape);
  return pieces;
}

// A face of the fused assembly as the part of lowest index sees it.
struct FusedFace {
  TopoDS_Face face;  // oriented outwards from back_part
  mesh::AssemblyFace description;
};

class Fusion {
 public:
  explicit Fusion(const std::vector<Solid>& solids) : solids_(solids) {}

  absl::Status Perform() {
    for (const Solid& solid : solids_) fuse_.AddArgument(solid.kernel().shape);
    fuse_.SetFuzzyValue(kFuseTolerance);
    fuse_.SetNonDestructive(Standard_True);
    fuse_.SetRunParallel(Standard_False);
    fuse_.Perform();
    if (fuse_.HasErrors()) return KernelFailure("fusing the parts", "the kernel reports an error");
    for (std::size_t part = 0; part < solids_.size(); ++part) {
      MORTISE_RETURN_IF_ERROR(CollectFaces(static_cast<int>(part)));
    }
    for (std::size_t part = 0; part < solids_.size(); ++part) NameFaces(static_cast<int>(part));
    return absl::OkStatus();
  }

  const std::vector<FusedFace>& faces() const { return faces_; }

 private:
  // Takes the faces of a part's solids; a face seen before is between two parts.
  absl::Status CollectFaces(int part) {
    const TopTools_ListOfShape pieces =
        PiecesOf(fuse_, solids_[static_cast<std::size_t>(part)].kernel().shape);
    // Where parts overlap, the overlap is a solid of its own that both are split by.
    if (pieces.Extent() != 1) return Penetrates(part);
    for (TopExp_Explorer face(pieces.First(), TopAbs_FACE); face.More(); face.Next()) {
      const int* known = index_.Seek(face.Current());
      if (known == nullptr) {
        index_.Bind(face.Current(), static_cast<int>(faces_.size()));
        faces_.push_back({TopoDS::Face(face.Current()), mesh::AssemblyFace{-1, part, {}}});
        continue;
      }
      mesh::AssemblyFace& description = faces_[static_cast<std::size_t>(*known)].description;
      if (description.front_part >= 0 || description.back_part == part) return Penetrates(part);
      description.front_part = part;
    }
    return absl::OkStatus();
  }

  // Notes from which named faces of the part the fused faces come.
  void NameFaces(int part) {
    const Solid::Kernel& kernel = solids_[static_cast<std::size_t>(part)].kernel();
    for (std::size_t i = 0; i < kernel.faces.size(); ++i) {
      for (const TopoDS_Shape& piece : PiecesOf(fuse_, kernel.faces[i])) {
        const int* known = index_.Seek(piece);
        if (known == nullptr) continue;
        faces_[static_cast<std::size_t>(*known)].description.origins.push_back(
            {part, kernel.face_names[i]});
      }
    }
  }

  absl::Status Penetrates(int part) const {
    return InvalidField(absl::StrCat("parts[", part, "]"),
                        absl::StrCat("'", solids_[static_cast<std::size_t>(part)].name(),
                                     "' penetrates another part"));
  }

  const std::vector<Solid>& solids_;
  BOPAlgo_Builder fuse_;
  TopTools_DataMapOfShapeInteger index_;  // of a face, whatever its orientation
  std::vector<FusedFace> faces_;
};

// Triangulates all faces together, so that those that share an edge share its points.
void Triangulate(const std::vector<FusedFace>& faces) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const FusedFace& face : faces) builder.Add(compound, face.face);
  BRepMesh_IncrementalMesh mesher(compound, kDeflection);
}

absl::Status AppendTriangles(const FusedFace& fused, int face_index, PointMerger& points,
                             std::vector<Eigen::Vector3i>& triangles,
                             std::vector<int>& triangle_face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(fused.face, location);
  if (mesh.IsNull()) return KernelFailure("triangulating the parts", "a face has no triangles");
  std::vector<int> indices;
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    const gp_Pnt point = mesh->Node(i).Transformed(location.Transformation());
    indices.push_back(points.IndexOf({point.X(), point.Y(), point.Z()}));
  }
  const bool reversed = fused.face.Orientation() == TopAbs_REVERSED;
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (reversed) std::swap(b, c);
    const Eigen::Vector3i triangle(indices[static_cast<std::size_t>(a - 1)],
                                   indices[static_cast<std::size_t>(b - 1)],
                                   indices[static_cast<std::size_t>(c - 1)]);
    if (triangle(0) == triangle(1) || triangle(1) == triangle(2) || triangle(2) == triangle(0)) {
      continue;
    }
    triangles.push_back(triangle);
    triangle_face.push_back(face_index);
  }
  return absl::OkStatus();
}

absl::StatusOr<mesh::AssemblySurface> Fuse(const std::vector<Solid>& solids) {
  Fusion fusion(solids);
  MORTISE_RETURN_IF_ERROR(fusion.Perform());
  Triangulate(fusion.faces());
  mesh::AssemblySurface surface;
  PointMerger points(kMergeTolerance);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> triangle_face;
  for (const FusedFace& face : fusion.faces()) {
    MORTISE_RETURN_IF_ERROR(AppendTriangles(face, static_cast<int>(surface.faces.size()), points,
                                            triangles, triangle_face));
    surface.faces.push_back(face.description);
  }
  surface.vertices = points.Points();
  surface.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  surface.triangle_face.resize(static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    surface.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
    surface.triangle_face(static_cast<Eigen::Index>(i)) = triangle_face[i];
  }
  return surface;
}

}  // namespace

absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<mesh::PartShape>& parts) {
  if (parts.empty()) return InvalidField("parts", "is empty");
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    absl::StatusOr<Solid> solid = Solid::FromPart(parts[i]);
    if (!solid.ok()) return UnderField(absl::StrCat("parts[", i, "]"), solid.status());
    solids.push_back(*std::move(solid));
  }
  try {
    MORTISE_ASSIGN_OR_RETURN(mesh::AssemblySurface surface, Fuse(solids));
    surface.part_interior.resize(3, static_cast<Eigen::Index>(parts.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      surface.part_interior.col(static_cast<Eigen::Index>(i)) = InteriorPoint(parts[i]);
      surface.part_names.push_back(parts[i].name);
    }
    return surface;
  } catch (const Standard_Failure& failure) {
    return KernelFailure("fusing the parts", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
