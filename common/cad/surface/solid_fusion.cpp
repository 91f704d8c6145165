#include "common/cad/surface/solid_fusion.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

// The pieces a shape was split into; itself if it was left whole, as all is if nothing was fused.
std::vector<TopoDS_Shape> PiecesOf(BOPAlgo_Builder& fuse, const TopoDS_Shape& shape) {
  if (fuse.Arguments().Extent() < 2) return {shape};
  const TopTools_ListOfShape& modified = fuse.Modified(shape);
  std::vector<TopoDS_Shape> pieces(modified.begin(), modified.end());
  if (pieces.empty() && !fuse.IsDeleted(shape)) pieces.push_back(shape);
  return pieces;
}

double SlabThickness(const TopoDS_Shape& solid) {
  GProp_GProps volume, surface;
  BRepGProp::VolumeProperties(solid, volume);
  BRepGProp::SurfaceProperties(solid, surface);
  return surface.Mass() > 0 ? 2 * std::abs(volume.Mass()) / surface.Mass() : 0;
}

}  // namespace

FusedPart CopyOf(const Solid& solid) {
  const Solid::Kernel& kernel = solid.kernel();
  FusedPart part;
  part.name = kernel.name;
  part.face_names = kernel.face_names;
  BRepBuilderAPI_Copy copy(kernel.shape, Standard_False, Standard_False);
  part.solid = copy.Shape();
  for (const TopoDS_Face& face : kernel.faces) {
    part.faces.push_back(TopoDS::Face(copy.ModifiedShape(face)));
  }
  Bnd_Box box;
  BRepBndLib::Add(part.solid, box, Standard_False);
  if (!box.IsVoid()) part.diagonal = std::sqrt(box.SquareExtent());
  return part;
}

absl::StatusOr<SolidFusion> SolidFusion::Create(const std::vector<FusedPart>& parts,
                                                double tolerance) {
  BOPAlgo_Builder fuse;
  for (const FusedPart& part : parts) fuse.AddArgument(part.solid);
  fuse.SetFuzzyValue(tolerance);
  fuse.SetNonDestructive(Standard_True);
  fuse.SetRunParallel(Standard_False);
  // The kernel takes two or more.
  if (parts.size() > 1) fuse.Perform();
  if (fuse.HasErrors()) return KernelFailure("fusing the parts", "the kernel reports an error");
  std::vector<std::vector<TopoDS_Shape>> pieces;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pieces.push_back(PiecesOf(fuse, parts[i].solid));
    if (pieces.back().empty()) {
      return InvalidField(absl::StrCat("parts[", i, "]"),
                          absl::StrCat("'", parts[i].name, "' vanishes among the others"));
    }
  }
  SolidFusion fusion;
  fusion.FindOverlaps(pieces);
  if (!fusion.overlaps_.empty()) return fusion;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const int part = static_cast<int>(i);
    if (pieces[i].size() != 1) {
      return InvalidField(absl::StrCat("parts[", i, "]"),
                          absl::StrCat("'", parts[i].name, "' is cut through by others"));
    }
    MORTISE_RETURN_IF_ERROR(fusion.CollectFaces(part, parts[i], pieces[i].front()));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    fusion.NameFaces(static_cast<int>(i), parts[i], fuse);
  }
  fusion.NoteMeetings(pieces);
  fusion.NoteCorners();
  return fusion;
}

bool SolidFusion::Meet(int first, int second) const {
  return meeting_.count(std::minmax(first, second)) != 0;
}

bool SolidFusion::Touch(int first, int second) const {
  const std::vector<int>& a = corners_[static_cast<std::size_t>(first)];
  const std::vector<int>& b = corners_[static_cast<std::size_t>(second)];
  std::vector<int> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return !common.empty();
}

// Where parts overlap, the overlap is a solid of its own that both are split into.
void SolidFusion::FindOverlaps(const std::vector<std::vector<TopoDS_Shape>>& pieces) {
  TopTools_DataMapOfShapeInteger owners;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (const TopoDS_Shape& piece : pieces[i]) {
      const int part = static_cast<int>(i);
      const int* owner = owners.Seek(piece);
      if (owner == nullptr) {
        owners.Bind(piece, part);
      } else if (*owner != part) {
        overlaps_.push_back({*owner, part, SlabThickness(piece)});
      }
    }
  }
}

// Takes the faces of a part; one seen before is between two parts.
absl::Status SolidFusion::CollectFaces(int part, const FusedPart& source,
                                       const TopoDS_Shape& piece) {
  for (TopExp_Explorer face(piece, TopAbs_FACE); face.More(); face.Next()) {
    const int* known = index_.Seek(face.Current());
    if (known == nullptr) {
      index_.Bind(face.Current(), static_cast<int>(faces_.size()));
      faces_.push_back({TopoDS::Face(face.Current()), mesh::AssemblyFace{-1, part, {}}});
      continue;
    }
    mesh::AssemblyFace& description = faces_[static_cast<std::size_t>(*known)].description;
    if (description.back_part == part || description.front_part >= 0) {
      return InvalidField(absl::StrCat("parts[", part, "]"),
                          absl::StrCat("'", source.name, "' touches itself"));
    }
    description.front_part = part;
  }
  return absl::OkStatus();
}

// Notes from which named faces of the part the fused faces come.
void SolidFusion::NameFaces(int part, const FusedPart& source, BOPAlgo_Builder& fuse) {
  for (std::size_t i = 0; i < source.faces.size(); ++i) {
    for (const TopoDS_Shape& piece : PiecesOf(fuse, source.faces[i])) {
      const int* known = index_.Seek(piece);
      if (known == nullptr) continue;
      auto& origins = faces_[static_cast<std::size_t>(*known)].description.origins;
      const mesh::NamedFace origin{part, source.face_names[i]};
      if (std::find(origins.begin(), origins.end(), origin) == origins.end()) {
        origins.push_back(origin);
      }
    }
  }
}

void SolidFusion::NoteMeetings(const std::vector<std::vector<TopoDS_Shape>>& pieces) {
  // Faces and edges have vertices.
  std::vector<std::vector<int>> owners(1);
  TopTools_IndexedMapOfShape vertices;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    TopTools_IndexedMapOfShape own;
    TopExp::MapShapes(pieces[i].front(), TopAbs_VERTEX, own);
    for (int v = 1; v <= own.Extent(); ++v) {
      const auto index = static_cast<std::size_t>(vertices.Add(own(v)));
      if (index >= owners.size()) owners.resize(index + 1);
      for (const int other : owners[index]) meeting_.emplace(other, static_cast<int>(i));
      owners[index].push_back(static_cast<int>(i));
    }
  }
}

void SolidFusion::NoteCorners() {
  TopTools_IndexedMapOfShape vertices;
  for (const FusedFace& face : faces_) {
    std::vector<int>& own = corners_.emplace_back();
    for (TopExp_Explorer corner(face.face, TopAbs_VERTEX); corner.More(); corner.Next()) {
      own.push_back(vertices.Add(corner.Current()));
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
}

}  // namespace mortise::cad
