// Fuses the parts' solids with Open CASCADE's general fuse and triangulates each piece once.
#include "common/cad/assembly_surface.h"

#include <BRepBndLib.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/cad/solid_fusion.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/triangle_joiner.h"
#include "common/mesh/inside_point.h"
#include "common/mesh/surface_check.h"

namespace mortise::cad {
namespace {

constexpr double kFuseTolerance = 1e-6;  // m; faces nearer than this are one
constexpr double kAngle = 0.5;           // rad, between neighbouring triangles of a curved face
constexpr double kLeastChord = 2e-5;     // m
constexpr double kClear = 0.3;           // of the way between two parts: what triangles may miss

// Two parts that do not touch.
struct Gap {
  int first = 0;
  int second = 0;
  double width = 0;  // m
};

std::string BothNames(const std::vector<FusedPart>& parts, int first, int second) {
  return absl::StrCat("'", parts[static_cast<std::size_t>(first)].name, "' and '",
                      parts[static_cast<std::size_t>(second)].name, "'");
}

absl::Status Penetration(const std::vector<FusedPart>& parts, const Overlap& overlap) {
  return InvalidField("parts", absl::StrFormat("%s penetrate each other, by about %.2g mm",
                                               BothNames(parts, overlap.first, overlap.second),
                                               1e3 * overlap.depth));
}

absl::Status NotBonded(const std::vector<FusedPart>& parts, const Gap& gap) {
  return PreconditionFailed(
      "NOT_BONDED",
      absl::StrFormat(
          "%s are %.2g mm apart and cannot be joined: let them touch, or leave more than "
          "%.2g mm between them",
          BothNames(parts, gap.first, gap.second), 1e3 * gap.width, 1e3 * kDrawingTolerance),
      "parts");
}

double ChordOf(const FusedPart& part) {
  return std::max(kLeastChord, kChordTolerance * part.diagonal);
}

// What the triangles may miss.
double MissOf(const FusedPart& part) { return part.is_flat ? 0 : ChordOf(part); }

// Parts that pass each other without touching, nearer than triangles may miss them.
std::vector<Gap> FindGaps(const std::vector<FusedPart>& parts, const SolidFusion& fusion) {
  std::vector<Bnd_Box> boxes(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    BRepBndLib::Add(parts[i].solid, boxes[i], Standard_False);
  }
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      const int first = static_cast<int>(i), second = static_cast<int>(j);
      const double near = kDrawingTolerance + MissOf(parts[i]) + MissOf(parts[j]);
      if (boxes[i].Distance(boxes[j]) > near || fusion.Meet(first, second)) continue;
      const BRepExtrema_DistShapeShape distance(parts[i].solid, parts[j].solid);
      if (distance.IsDone() && distance.Value() <= near) {
        gaps.push_back({first, second, distance.Value()});
      }
    }
  }
  return gaps;
}

const Gap* NarrowestOf(const std::vector<Gap>& gaps) {
  const auto found = std::min_element(gaps.begin(), gaps.end(),
                                      [](const Gap& a, const Gap& b) { return a.width < b.width; });
  return found == gaps.end() ? nullptr : &*found;
}

// The parts fused, and how far triangles may miss each.
struct Fused {
  SolidFusion fusion;
  std::vector<double> chords;  // m
};

absl::StatusOr<Fused> FuseWithin(const std::vector<FusedPart>& parts) {
  MORTISE_ASSIGN_OR_RETURN(SolidFusion fusion, SolidFusion::Create(parts, kFuseTolerance));
  for (const Overlap& overlap : fusion.overlaps()) {
    if (overlap.depth > kDrawingTolerance) return Penetration(parts, overlap);
  }
  std::vector<Gap> gaps;
  if (fusion.overlaps().empty()) gaps = FindGaps(parts, fusion);
  const Gap* narrowest = NarrowestOf(gaps);
  if (!fusion.overlaps().empty() ||
      (narrowest != nullptr && narrowest->width <= kDrawingTolerance)) {
    MORTISE_ASSIGN_OR_RETURN(fusion, SolidFusion::Create(parts, kDrawingTolerance));
    if (!fusion.overlaps().empty()) return Penetration(parts, fusion.overlaps().front());
    gaps = FindGaps(parts, fusion);
    narrowest = NarrowestOf(gaps);
    if (narrowest != nullptr && narrowest->width <= kDrawingTolerance) {
      return NotBonded(parts, *narrowest);
    }
  }
  Fused fused{std::move(fusion), {}};
  for (const FusedPart& part : parts) fused.chords.push_back(ChordOf(part));
  for (const Gap& gap : gaps) {
    for (const int part : {gap.first, gap.second}) {
      double& chord = fused.chords[static_cast<std::size_t>(part)];
      chord = std::min(chord, std::max(kLeastChord, kClear * gap.width));
    }
  }
  return fused;
}

// Triangulates part by part, the finest first: what has triangles that are fine enough keeps them,
// and its edges give their points to the faces beside.
void Triangulate(const Fused& fused) {
  std::vector<int> order(fused.chords.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return fused.chords[static_cast<std::size_t>(a)] < fused.chords[static_cast<std::size_t>(b)];
  });
  for (const int part : order) {
    TopoDS_Compound compound;
    BRep_Builder builder;
    builder.MakeCompound(compound);
    for (const int face : fused.fusion.FacesOf(part)) {
      builder.Add(compound, fused.fusion.faces()[static_cast<std::size_t>(face)].face);
    }
    BRepMesh_IncrementalMesh mesher(compound, fused.chords[static_cast<std::size_t>(part)],
                                    Standard_False, kAngle, Standard_False);
  }
}

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const std::vector<FusedPart>& parts) {
  MORTISE_ASSIGN_OR_RETURN(const Fused fused, FuseWithin(parts));
  Triangulate(fused);
  mesh::AssemblySurface surface;
  TriangleJoiner joiner;
  for (const FusedFace& face : fused.fusion.faces()) {
    MORTISE_RETURN_IF_ERROR(joiner.Append(face.face, static_cast<int>(surface.faces.size())));
    surface.faces.push_back(face.description);
  }
  joiner.MoveTo(surface);
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
  return surface;
}

}  // namespace

absl::StatusOr<mesh::AssemblySurface> FuseAssembly(const std::vector<Solid>& parts) {
  if (parts.empty()) return InvalidField("parts", "is empty");
  try {
    std::vector<FusedPart> copies;
    for (const Solid& solid : parts) copies.push_back(CopyOf(solid));
    return SurfaceOf(copies);
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
