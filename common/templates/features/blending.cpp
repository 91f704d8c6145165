#include "common/templates/features/blending.h"

#include <BRepFilletAPI_MakeChamfer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/forked_attempt.h"

namespace mortise::cad {
namespace {

using Blend = std::unique_ptr<BRepFilletAPI_LocalOperation>;

// Of processor time. No blend of any shape that ships takes a tenth of this.
constexpr std::chrono::seconds kTimeLimit{10};
// Blends are made at once where another edge is so many times farther than it may be.
constexpr double kAmple = 1.5;
// Of the size that has room, or is asked for, what is tried to name one that can be made.
constexpr std::array<double, 4> kShares = {0.95, 0.75, 0.5, 0.25};

// How a kind of blend is told of.
struct Wording {
  const char* field;
  const char* done;  // "edges cannot be …"
  const char* size;
};

Wording WordingOf(BlendKind kind) {
  return kind == BlendKind::kFillet ? Wording{"fillet.radius", "rounded with", "radius"}
                                    : Wording{"chamfer.distance", "bevelled by", "distance"};
}

// The operation, not done yet. `size` is in mm.
Blend Prepare(BlendKind kind, const TopoDS_Shape& shape, const std::vector<TopoDS_Edge>& edges,
              double size) {
  // An edge may have been taken along by one that it continues smoothly.
  if (kind == BlendKind::kFillet) {
    auto maker = std::make_unique<BRepFilletAPI_MakeFillet>(shape);
    for (const TopoDS_Edge& edge : edges) {
      if (maker->Contour(edge) == 0) maker->Add(size, edge);
    }
    return maker;
  }
  auto maker = std::make_unique<BRepFilletAPI_MakeChamfer>(shape);
  for (const TopoDS_Edge& edge : edges) {
    if (maker->Contour(edge) == 0) maker->Add(size, edge);
  }
  return maker;
}

// All edges that are blended: those that were asked for and those that continue them.
std::vector<TopoDS_Edge> BlendedBy(const BRepFilletAPI_LocalOperation& blend) {
  std::vector<TopoDS_Edge> edges;
  for (int contour = 1; contour <= blend.NbContours(); ++contour) {
    for (int i = 1; i <= blend.NbEdges(contour); ++i) edges.push_back(blend.Edge(contour, i));
  }
  return edges;
}

// The reference that means an edge, or the one that it continues.
std::string ReferenceOf(const TopoDS_Edge& edge, const BRepFilletAPI_LocalOperation& blend,
                        const FoundEdges& found) {
  const int contour = blend.Contour(edge);
  std::string reference = found.references.front();
  for (std::size_t i = 0; i < found.edges.size(); ++i) {
    if (found.edges[i].IsSame(edge)) return found.references[i];
    if (contour > 0 && blend.Contour(found.edges[i]) == contour) reference = found.references[i];
  }
  return reference;
}

absl::StatusOr<AttemptEnd> Attempt(BlendKind kind, const TopoDS_Shape& shape,
                                   const std::vector<TopoDS_Edge>& edges, double size) {
  return AttemptInCopy(
      [&] {
        const Blend blend = Prepare(kind, shape, edges, size);
        blend->Build();
        return blend->IsDone() && !blend->Shape().IsNull();
      },
      kTimeLimit);
}

// To two digits, not more than it was.
double RoundedDown(double size) {
  const double unit = std::pow(10, std::floor(std::log10(size)) - 1);
  return std::floor(size / unit * (1 + 1e-12)) * unit;
}

// The first of some smaller sizes that can be made, mm; nothing if none of those that are tried
// can.
std::optional<double> SmallerSize(BlendKind kind, const TopoDS_Shape& shape,
                                  const std::vector<TopoDS_Edge>& edges, double size) {
  for (const double share : kShares) {
    const double smaller = RoundedDown(share * size);
    const absl::StatusOr<AttemptEnd> end = Attempt(kind, shape, edges, smaller);
    if (end.ok() && *end == AttemptEnd::kDone) return smaller;
  }
  return std::nullopt;
}

std::string Metres(double millimetres) { return absl::StrCat(millimetres / kModelScale, " m"); }

}  // namespace

absl::StatusOr<std::unique_ptr<BRepFilletAPI_LocalOperation>> BlendEdges(BlendKind kind,
                                                                         const TopoDS_Shape& shape,
                                                                         const FoundEdges& edges,
                                                                         const std::string& feature,
                                                                         double size) {
  const Wording wording = WordingOf(kind);
  const double scaled = size * kModelScale;
  const std::string refusal = absl::StrCat("edges cannot be ", wording.done, " ", size, " m");
  Blend blend = Prepare(kind, shape, edges.edges, scaled);
  const std::vector<TopoDS_Edge> blended = BlendedBy(*blend);
  const BlendRoom room = RoomBeside(shape, blended, kind, kAmple * scaled);
  if (room.size < kAmple * scaled) {
    MORTISE_ASSIGN_OR_RETURN(const AttemptEnd end, Attempt(kind, shape, edges.edges, scaled));
    if (end != AttemptEnd::kDone) {
      const double most = room.size > 0 ? std::min(room.size, scaled) : scaled;
      const std::optional<double> smaller = SmallerSize(kind, shape, edges.edges, most);
      return InvalidField(wording.field,
                          absl::StrCat(refusal, ": '", feature, "' meets another edge beside '",
                                       ReferenceOf(blended[room.edge], *blend, edges), "'",
                                       smaller ? absl::StrCat("; a ", wording.size, " of ",
                                                              Metres(*smaller), " can be made")
                                               : ""));
    }
  }
  blend->Build();
  if (!blend->IsDone()) {
    return InvalidField(wording.field, absl::StrCat(refusal, ": '", feature,
                                                    "' is too large for the faces beside them"));
  }
  return blend;
}

}  // namespace mortise::cad
