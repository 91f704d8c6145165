// Looks up the faces and edges that references mean, and says why there are none.
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/features/named_body.h"

namespace mortise::cad {
namespace {

constexpr double kSmoothAngle = 1e-3;  // rad; faces that meet at less are tangent

// A reference to a pattern also means its source where instance 0 is asked for.
std::vector<FaceName> Alternatives(const ModelState& state, const FaceName& reference) {
  std::vector<FaceName> alternatives = {reference};
  const auto pattern = state.patterns.find(reference.feature);
  if (pattern != state.patterns.end() && reference.instance <= 0) {
    alternatives.push_back({pattern->second.source, kNoInstance, reference.role});
  }
  return alternatives;
}

bool MatchesAny(const std::vector<FaceName>& references, const FaceName& name) {
  for (const FaceName& reference : references) {
    if (Matches(reference, name)) return true;
  }
  return false;
}

std::string WhyNothing(const ModelState& state, const FaceName& reference) {
  const auto pattern = state.patterns.find(reference.feature);
  if (pattern != state.patterns.end() && reference.instance >= pattern->second.count) {
    return absl::StrCat("there is no '", ToString(reference), "': the pattern has ",
                        pattern->second.count, " instances");
  }
  const std::vector<FaceName> alternatives = Alternatives(state, reference);
  for (const NamedBody& body : state.bodies) {
    for (const NamedFaces& named : body.names) {
      if (!named.removed_by.empty() && MatchesAny(alternatives, named.name)) {
        return absl::StrCat("face '", ToString(reference), "' was removed by '", named.removed_by,
                            "'");
      }
    }
  }
  return absl::StrCat("there is no face '", ToString(reference), "' at these parameters");
}

// The faces of one reference; the body they are of must be `body` if that is known.
absl::Status AppendFaces(const ModelState& state, const FaceName& reference,
                         std::optional<std::size_t>& body, TopTools_IndexedMapOfShape& found) {
  const std::vector<FaceName> alternatives = Alternatives(state, reference);
  const int before = found.Extent();
  bool any = false;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    for (const NamedFaces& named : state.bodies[i].names) {
      if (named.faces.empty() || !MatchesAny(alternatives, named.name)) continue;
      if (body.value_or(i) != i) {
        return absl::InvalidArgumentError(absl::StrCat("'", ToString(reference), "' is on body '",
                                                       state.bodies[i].name, "', others are on '",
                                                       state.bodies[*body].name, "'"));
      }
      body = i;
      any = true;
      for (const TopoDS_Face& face : named.faces) found.Add(face);
    }
  }
  if (any || found.Extent() > before) return absl::OkStatus();
  return absl::InvalidArgumentError(WhyNothing(state, reference));
}

bool IsSmooth(const TopoDS_Edge& edge, const TopoDS_Shape& first, const TopoDS_Shape& second) {
  return BRep_Tool::HasContinuity(edge, TopoDS::Face(first), TopoDS::Face(second)) &&
         BRep_Tool::Continuity(edge, TopoDS::Face(first), TopoDS::Face(second)) >= GeomAbs_G1;
}

// Appends the edges between faces of `from` and of `to`, or all of `from` if `to` is null.
void AppendEdges(const TopTools_IndexedDataMapOfShapeListOfShape& neighbours,
                 const TopTools_IndexedMapOfShape& from, const TopTools_IndexedMapOfShape* to,
                 TopTools_IndexedMapOfShape& found) {
  for (int i = 1; i <= neighbours.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(neighbours.FindKey(i));
    const TopTools_ListOfShape& faces = neighbours(i);
    if (faces.Extent() != 2 || BRep_Tool::Degenerated(edge)) continue;
    const TopoDS_Shape& a = faces.First();
    const TopoDS_Shape& b = faces.Last();
    if (a.IsSame(b)) continue;  // the seam of a closed surface
    const bool meets = to == nullptr ? from.Contains(a) != from.Contains(b) && !IsSmooth(edge, a, b)
                                     : (from.Contains(a) && to->Contains(b)) ||
                                           (from.Contains(b) && to->Contains(a));
    if (meets) found.Add(edge);
  }
}

std::string Indexed(const std::string& field, std::size_t index) {
  return absl::StrCat(field, "[", index, "]");
}

}  // namespace

absl::StatusOr<FoundFaces> FindFaces(const ModelState& state,
                                     const std::vector<std::string>& references,
                                     const std::string& field) {
  TopTools_IndexedMapOfShape found;
  std::optional<std::size_t> body;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const auto reference = ParseFaceReference(references[i]);
    const absl::Status status =
        reference.ok() ? AppendFaces(state, *reference, body, found) : reference.status();
    if (!status.ok()) return InvalidField(Indexed(field, i), std::string(status.message()));
  }
  FoundFaces result{body.value_or(0), {}};
  for (int i = 1; i <= found.Extent(); ++i) result.faces.push_back(TopoDS::Face(found(i)));
  return result;
}

absl::StatusOr<FoundEdges> FindEdges(const ModelState& state,
                                     const std::vector<std::string>& references,
                                     const std::string& field) {
  TopTools_IndexedMapOfShape found;
  std::vector<std::string> meaning;
  std::optional<std::size_t> body;
  TopTools_IndexedDataMapOfShapeListOfShape neighbours;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const auto reference = ParseEdgeReference(references[i]);
    if (!reference.ok()) {
      return InvalidField(Indexed(field, i), std::string(reference.status().message()));
    }
    TopTools_IndexedMapOfShape from, to;
    absl::Status status = AppendFaces(state, reference->face, body, from);
    if (status.ok() && reference->other) status = AppendFaces(state, *reference->other, body, to);
    if (!status.ok()) return InvalidField(Indexed(field, i), std::string(status.message()));
    if (neighbours.IsEmpty()) {
      const TopoDS_Shape& shape = state.bodies[*body].shape;
      BRepLib::EncodeRegularity(shape, kSmoothAngle);
      TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, neighbours);
    }
    TopTools_IndexedMapOfShape edges;
    AppendEdges(neighbours, from, reference->other ? &to : nullptr, edges);
    if (edges.IsEmpty()) {
      return InvalidField(
          Indexed(field, i),
          reference->other
              ? absl::StrCat("faces '", ToString(reference->face), "' and '",
                             ToString(*reference->other), "' do not meet at these parameters")
              : absl::StrCat("face '", ToString(reference->face), "' has no sharp edge"));
    }
    for (int e = 1; e <= edges.Extent(); ++e) found.Add(edges(e));
    meaning.resize(static_cast<std::size_t>(found.Extent()), references[i]);
  }
  FoundEdges result{body.value_or(0), {}, std::move(meaning)};
  for (int i = 1; i <= found.Extent(); ++i) result.edges.push_back(TopoDS::Edge(found(i)));
  return result;
}

}  // namespace mortise::cad
