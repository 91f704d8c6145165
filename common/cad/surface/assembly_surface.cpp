// Fuses the parts' solids with Open CASCADE's general fuse and triangulates each piece once.
#include "common/cad/surface/assembly_surface.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <Eigen/Geometry>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/surface/edge_lengths.h"
#include "common/cad/surface/exact_middles.h"
#include "common/cad/surface/facet_balance.h"
#include "common/cad/surface/gmsh_triangles.h"
#include "common/cad/surface/part_gaps.h"
#include "common/cad/surface/solid_fusion.h"
#include "common/cad/triangle_joiner.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/measures/inside_point.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/mesher.h"

namespace mortise::cad {
namespace {

// m; faces nearer than this are one. The first is for drawings that are exact; the others are tried
// in turn on those that are not, so that no more becomes one than must.
constexpr std::array<double, 5> kFuseTolerances = {1e-6, 2e-6, 1e-5, 3e-5, kDrawingTolerance};
constexpr double kAngle = 0.5;      // rad, between neighbouring triangles of a curved face
constexpr double kMinChord = 2e-5;  // m
constexpr double kClear = 0.3;      // of the way between two parts: what triangles may miss
constexpr std::size_t kPairsTold = 4;
// Of the length of edges: what is tried in turn.
constexpr std::array<double, 3> kShares = {1, 0.6, 0.35};
constexpr double kSameVolume = 0.01;
constexpr double kMaxTriangles = 100'000;  // four seconds of Gmsh's

std::string BothNames(const std::vector<FusedPart>& parts, int first, int second) {
  return absl::StrCat("'", parts[static_cast<std::size_t>(first)].name, "' and '",
                      parts[static_cast<std::size_t>(second)].name, "'");
}

// Names the pairs of parts that are in the same place, each with its deepest overlap.
absl::Status Penetration(const std::vector<FusedPart>& parts,
                         const std::vector<Overlap>& overlaps) {
  std::map<std::pair<int, int>, double> depths;
  for (const Overlap& overlap : overlaps) {
    double& depth = depths[std::minmax(overlap.first, overlap.second)];
    depth = std::max(depth, overlap.depth);
  }
  std::string message;
  std::size_t told = 0;
  for (const auto& [pair, depth] : depths) {
    if (++told > kPairsTold) break;
    absl::StrAppendFormat(&message, "%s%s%s, by about %.2g mm", told == 1 ? "" : "; so do ",
                          BothNames(parts, pair.first, pair.second),
                          told == 1 ? " penetrate each other" : "", 1e3 * depth);
  }
  if (depths.size() > kPairsTold) {
    absl::StrAppend(&message, "; and ", depths.size() - kPairsTold, " more pairs");
  }
  return InvalidField("parts", message);
}

absl::Status NotBonded(const std::vector<FusedPart>& parts, const SolidFusion& fusion,
                       const FaceGap& gap) {
  const auto part_of = [&](int face) {
    return fusion.faces()[static_cast<std::size_t>(face)].description.back_part;
  };
  return PreconditionFailed(
      "NOT_BONDED",
      absl::StrFormat(
          "%s are %.2g mm apart and cannot be joined: let them touch, or leave more than "
          "%.2g mm between them",
          BothNames(parts, part_of(gap.first), part_of(gap.second)), 1e3 * gap.width,
          1e3 * kDrawingTolerance),
      "parts");
}

// How far triangles of each face may miss it, as its parts are large.
std::vector<double> ChordsOf(const std::vector<FusedPart>& parts, const SolidFusion& fusion) {
  std::vector<double> chords;
  for (const FusedFace& face : fusion.faces()) {
    double diagonal = parts[static_cast<std::size_t>(face.description.back_part)].diagonal;
    if (face.description.front_part >= 0) {
      diagonal =
          std::min(diagonal, parts[static_cast<std::size_t>(face.description.front_part)].diagonal);
    }
    chords.push_back(std::max(kMinChord, kChordTolerance * diagonal));
  }
  return chords;
}

// How far triangles miss each face with these chords: planes not at all, and cylinders no more than
// the angle between two triangles lets them.
std::vector<double> MissesOf(const SolidFusion& fusion, std::vector<double> chords) {
  for (std::size_t i = 0; i < chords.size(); ++i) {
    const BRepAdaptor_Surface surface(fusion.faces()[i].face, Standard_False);
    if (surface.GetType() == GeomAbs_Plane) chords[i] = 0;
    if (surface.GetType() == GeomAbs_Cylinder) {
      chords[i] = std::min(chords[i], surface.Cylinder().Radius() * kAngle * kAngle / 8);
    }
  }
  return chords;
}

// The parts fused, and how far triangles may miss each face.
struct Fused {
  SolidFusion fusion;
  std::vector<double> chords;  // m
};

// Triangles pass through no gap.
Fused Refined(SolidFusion fusion, const std::vector<FaceGap>& gaps, std::vector<double> chords) {
  for (const FaceGap& gap : gaps) {
    for (const int face : {gap.first, gap.second}) {
      double& chord = chords[static_cast<std::size_t>(face)];
      chord = std::min(chord, std::max(kMinChord, kClear * gap.width));
    }
  }
  return Fused{std::move(fusion), std::move(chords)};
}

absl::StatusOr<Fused> FuseWithin(const std::vector<FusedPart>& parts) {
  absl::Status failure;
  double wanted = 0;  // m: what nearly touches misses by no less
  for (const double tolerance : kFuseTolerances) {
    if (tolerance < wanted && tolerance < kFuseTolerances.back()) continue;
    MORTISE_ASSIGN_OR_RETURN(SolidFusion fusion, SolidFusion::Create(parts, tolerance));
    if (!fusion.overlaps().empty()) {
      failure = Penetration(parts, fusion.overlaps());
      for (const Overlap& overlap : fusion.overlaps()) wanted = std::max(wanted, overlap.depth);
      if (wanted > kDrawingTolerance) return failure;
      continue;
    }
    std::vector<double> chords = ChordsOf(parts, fusion);
    const std::vector<FaceGap> gaps = FindGaps(fusion, kDrawingTolerance, MissesOf(fusion, chords));
    failure = absl::OkStatus();
    for (const FaceGap& gap : gaps) {
      if (!gap.is_between || gap.width > kDrawingTolerance) continue;
      failure = NotBonded(parts, fusion, gap);
      wanted = std::max(wanted, gap.width);
    }
    if (failure.ok()) return Refined(std::move(fusion), gaps, std::move(chords));
  }
  return failure;
}

// Triangulates the faces, the finest first, together with those beside them that already have
// triangles: these keep them, and their edges give the points to the faces beside.
void Triangulate(const Fused& fused) {
  const std::vector<FusedFace>& faces = fused.fusion.faces();
  std::map<double, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < faces.size(); ++i) groups[fused.chords[i]].push_back(i);
  TopTools_IndexedDataMapOfShapeListOfShape beside;  // the faces at each edge
  for (const FusedFace& face : faces) {
    TopExp::MapShapesAndAncestors(face.face, TopAbs_EDGE, TopAbs_FACE, beside);
  }
  TopTools_MapOfShape done;
  for (const auto& [chord, members] : groups) {
    TopoDS_Compound compound;
    BRep_Builder builder;
    builder.MakeCompound(compound);
    TopTools_MapOfShape added;
    for (const std::size_t member : members) {
      builder.Add(compound, faces[member].face);
      for (TopExp_Explorer edge(faces[member].face, TopAbs_EDGE); edge.More(); edge.Next()) {
        for (const TopoDS_Shape& other : beside.FindFromKey(edge.Current())) {
          if (done.Contains(other) && added.Add(other)) builder.Add(compound, other);
        }
      }
    }
    BRepMesh_IncrementalMesh mesher(compound, chord, Standard_False, kAngle, Standard_False);
    for (const std::size_t member : members) done.Add(faces[member].face);
  }
}

// The kernel's triangles, joined at what the faces share.
absl::StatusOr<mesh::AssemblySurface> Joined(const std::vector<FusedPart>& parts,
                                             const SolidFusion& fusion) {
  mesh::AssemblySurface surface;
  TriangleJoiner joiner;
  FacetBalance balance;
  ExactMiddles middles;
  for (const FusedFace& face : fusion.faces()) {
    const absl::StatusOr<std::vector<int>> points =
        joiner.Append(face.face, static_cast<int>(surface.faces.size()));
    if (!points.ok()) {
      const auto part = static_cast<std::size_t>(face.description.back_part);
      return KernelFailure("fusing the parts",
                           absl::StrCat("'", parts[part].name, "': ", points.status().message()));
    }
    balance.Add(face.face, *points);
    middles.Add(face.face, *points);
    surface.faces.push_back(face.description);
  }
  joiner.MoveTo(surface);
  surface.exact = middles.Find(surface);
  balance.Apply(surface);
  return surface;
}

// Adds the names of the parts, and points inside them. INTERNAL where a part is not closed.
absl::Status CompleteParts(const std::vector<FusedPart>& parts, mesh::AssemblySurface& surface) {
  surface.part_interior.resize(3, static_cast<Eigen::Index>(parts.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const mesh::SurfaceMesh own = mesh::PartSurface(surface, static_cast<int>(i));
    if (!mesh::IsWatertight(own)) {
      return KernelFailure("fusing the parts",
                           absl::StrCat("the triangles of '", parts[i].name, "' leave a gap"));
    }
    MORTISE_ASSIGN_OR_RETURN(surface.part_interior.col(static_cast<Eigen::Index>(i)),
                             mesh::InsidePoint(own));
    surface.part_names.push_back(parts[i].name);
  }
  return absl::OkStatus();
}

// The surface in triangles with edges of these lengths, m, on each face.
absl::StatusOr<mesh::AssemblySurface> DrawnRound(const std::vector<FusedPart>& parts,
                                                 const std::vector<TopoDS_Face>& faces,
                                                 const std::vector<double>& lengths,
                                                 const std::vector<mesh::AssemblyFace>& described) {
  MORTISE_ASSIGN_OR_RETURN(GmshTriangles drawn, TriangulateWithGmsh(faces, lengths));
  mesh::AssemblySurface surface;
  surface.vertices = std::move(drawn.vertices);
  surface.triangles = std::move(drawn.triangles);
  surface.triangle_face = std::move(drawn.triangle_face);
  surface.faces = described;
  FacetBalance balance;
  ExactMiddles middles;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    balance.Add(faces[i], drawn.nodes[i]);
    middles.Add(faces[i], drawn.nodes[i]);
  }
  surface.exact = middles.Find(surface);
  balance.Apply(surface);
  MORTISE_RETURN_IF_ERROR(CompleteParts(parts, surface));
  if (!mesh::FindIntersections(surface.vertices, surface.triangles).empty()) {
    return KernelFailure("drawing triangles", "some cross");
  }
  return surface;
}

// Whether all parts have nearly the volume in one surface that they have in the other.
bool EncloseTheSame(const mesh::AssemblySurface& one, const mesh::AssemblySurface& other) {
  for (std::size_t i = 0; i < one.part_names.size(); ++i) {
    const auto volume = [&](const mesh::AssemblySurface& surface) {
      return mesh::ComputeMassProperties(mesh::PartSurface(surface, static_cast<int>(i))).volume;
    };
    const double wanted = volume(other);
    if (!(std::abs(volume(one) - wanted) <= kSameVolume * wanted)) return false;
  }
  return true;
}

// How many triangles Gmsh draws for edges of these lengths, m, on each face: short ones on an edge
// make those of the faces beside it short, as far as these go without another edge.
double EstimateTriangles(const mesh::AssemblySurface& surface, const std::vector<double>& lengths) {
  const auto of_face = [&](Eigen::Index t) {
    return lengths[static_cast<std::size_t>(surface.triangle_face(t))];
  };
  Eigen::VectorXd at_vertex =
      Eigen::VectorXd::Constant(surface.vertices.cols(), std::numeric_limits<double>::infinity());
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (const int v : surface.triangles.col(t)) at_vertex(v) = std::min(at_vertex(v), of_face(t));
  }
  double count = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Eigen::Vector3d first = surface.vertices.col(corners(0));
    const double twice = (surface.vertices.col(corners(1)) - first)
                             .cross(surface.vertices.col(corners(2)) - first)
                             .norm();
    const double mean = (at_vertex(corners(0)) + at_vertex(corners(1)) + at_vertex(corners(2))) / 3;
    const double length = std::min(of_face(t), mean);
    count += twice / (std::sqrt(0.75) * length * length);
  }
  return count;
}

// Instead of `surface`, which has the kernel's triangles, triangles as wide as they are high.
// Where they cross others, in a sharp corner between faces, shorter ones may not.
absl::StatusOr<mesh::AssemblySurface> DrawnRound(const std::vector<FusedPart>& parts,
                                                 const Fused& fused, double element_size,
                                                 mesh::AssemblySurface surface) {
  std::vector<TopoDS_Face> faces;
  for (const FusedFace& face : fused.fusion.faces()) faces.push_back(face.face);
  const std::vector<double> radii = LeastRadii(faces);
  if (std::none_of(radii.begin(), radii.end(), [](double r) { return std::isfinite(r); })) {
    return surface;
  }
  for (const double share : kShares) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const double wanted = EdgeLength(radii[i], element_size);
      lengths.push_back(share * std::min(wanted, std::sqrt(8 * radii[i] * fused.chords[i])));
    }
    if (EstimateTriangles(surface, lengths) > kMaxTriangles) break;
    absl::StatusOr<mesh::AssemblySurface> drawn = DrawnRound(parts, faces, lengths, surface.faces);
    if (drawn.ok() && EncloseTheSame(*drawn, surface)) return drawn;
    if (DetailOf(drawn.status()).reason == kNoGmsh) return drawn.status();
  }
  return surface;
}

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const std::vector<FusedPart>& parts,
                                                const FuseOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const Fused fused, FuseWithin(parts));
  Triangulate(fused);
  MORTISE_ASSIGN_OR_RETURN(mesh::AssemblySurface surface, Joined(parts, fused.fusion));
  MORTISE_RETURN_IF_ERROR(CompleteParts(parts, surface));
  if (!options.element_size) return surface;
  const double size =
      *options.element_size > 0 ? *options.element_size : mesh::DefaultElementSize(surface);
  return DrawnRound(parts, fused, size, std::move(surface));
}

}  // namespace

absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<Solid>& parts,
                                                   const FuseOptions& options) {
  if (parts.empty()) return InvalidField("parts", "is empty");
  try {
    std::vector<FusedPart> copies;
    for (const Solid& solid : parts) copies.push_back(CopyOf(solid));
    return SurfaceOf(copies, options);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("fusing the parts", failure.GetMessageString());
  }
}

absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<mesh::PartShape>& parts) {
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    absl::StatusOr<Solid> solid = Solid::FromPart(parts[i]);
    if (!solid.ok()) return UnderField(absl::StrCat("parts[", i, "]"), solid.status());
    solids.push_back(*std::move(solid));
  }
  return FuseAssembly(solids);
}

}  // namespace mortise::cad
