#include "common/fields/design_fields.h"

#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::fields {
namespace {

std::string Entry(const char* list, std::size_t index) {
  return absl::StrCat(list, "[", index, "]");
}

absl::Status CheckName(const std::string& name, const std::string& field) {
  if (name.size() <= kMaximumNameLength) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("is longer than ", kMaximumNameLength, " bytes"));
}

// Of things that are told apart by it.
template <typename Names>
absl::Status CheckOwnName(const std::string& name, const std::string& field, Names& names) {
  if (name.empty()) return InvalidField(field, "must not be empty");
  MORTISE_RETURN_IF_ERROR(CheckName(name, field));
  if (names.insert(name).second) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("'", name, "' is there twice"));
}

absl::Status CheckCount(Eigen::Index count, const std::string& field, int most = kMaximumCount) {
  if (count <= most) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("has more than ", most, " entries"));
}

// Of a list that is one of several, which had `before` entries together before this one.
absl::Status CheckTotal(Eigen::Index before, Eigen::Index count, const std::string& field) {
  if (count <= kMaximumPositions - before) return absl::OkStatus();
  return InvalidField(
      field, absl::StrCat("is more than the ", kMaximumPositions, " that all may have together"));
}

// Whether all of the indices are of `count` things.
template <typename Indices>
bool AreIndices(const Indices& indices, Eigen::Index count) {
  return indices.size() == 0 || (indices.minCoeff() >= 0 && indices.maxCoeff() < count);
}

// Of the columns of `cells`, each of which names nodes.
absl::Status CheckNodesOf(const Eigen::MatrixXi& cells, Eigen::Index nodes, const char* field) {
  for (Eigen::Index i = 0; i < cells.cols(); ++i) {
    if (AreIndices(cells.col(i), nodes)) continue;
    return InvalidField(Entry(field, static_cast<std::size_t>(i)),
                        absl::StrCat("names a node that is not there; there are ", nodes));
  }
  return absl::OkStatus();
}

absl::Status CheckTetrahedra(const DesignFields& design) {
  const Eigen::Index elements = design.tetrahedra.cols();
  MORTISE_RETURN_IF_ERROR(CheckCount(elements, "tetrahedra"));
  if (elements > 0 && design.tetrahedra.rows() != 4 && design.tetrahedra.rows() != 10) {
    return InvalidField("tetrahedra", "must have 4 or 10 nodes each");
  }
  MORTISE_RETURN_IF_ERROR(CheckNodesOf(design.tetrahedra, design.nodes.cols(), "tetrahedra"));
  if (design.tetrahedron_part.size() != elements) {
    return InvalidField("tetrahedron_part", "must have an entry for each tetrahedron");
  }
  if (AreIndices(design.tetrahedron_part, std::ssize(design.parts))) return absl::OkStatus();
  return InvalidField("tetrahedron_part", "names a part that is not there");
}

absl::Status CheckTriangles(const DesignFields& design) {
  const Eigen::Index count = design.triangles.cols();
  MORTISE_RETURN_IF_ERROR(CheckCount(count, "triangles"));
  if (count == 0) return InvalidField("triangles", "must be at least one");
  if (design.triangles.rows() != 3 && design.triangles.rows() != 6) {
    return InvalidField("triangles", "must have 3 or 6 nodes each");
  }
  MORTISE_RETURN_IF_ERROR(CheckNodesOf(design.triangles, design.nodes.cols(), "triangles"));
  for (const auto& [side, field] : {std::pair(&design.triangle_back, "triangle_back"),
                                    std::pair(&design.triangle_front, "triangle_front")}) {
    if (side->size() != count) {
      return InvalidField(field, "must have an entry for each triangle");
    }
    if (side->minCoeff() < -1 || side->maxCoeff() >= std::ssize(design.parts)) {
      return InvalidField(field, "names a part that is not there");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckRegions(const DesignFields& design) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < design.regions.size(); ++i) {
    const Region& region = design.regions[i];
    const std::string field = Entry("regions", i);
    MORTISE_RETURN_IF_ERROR(CheckOwnName(region.name, field + ".name", names));
    int last = -1;
    for (const int triangle : region.triangles) {
      if (triangle <= last || triangle >= design.triangles.cols()) {
        return InvalidField(field + ".triangles", "must be numbers of triangles that ascend");
      }
      last = triangle;
    }
  }
  return absl::OkStatus();
}

absl::Status CheckControlPoints(const DesignFields& design) {
  MORTISE_RETURN_IF_ERROR(
      CheckCount(std::ssize(design.control_points), "control_points", kMaximumControls));
  std::set<std::string_view> ids;
  for (std::size_t i = 0; i < design.control_points.size(); ++i) {
    const ControlPoint& point = design.control_points[i];
    const std::string field = Entry("control_points", i);
    MORTISE_RETURN_IF_ERROR(CheckOwnName(point.id, field + ".id", ids));
    if (!point.position.allFinite()) return InvalidField(field + ".position", "must be finite");
    if (point.node >= -1 && point.node < design.nodes.cols()) continue;
    return InvalidField(field + ".node", "is not there");
  }
  return absl::OkStatus();
}

absl::Status CheckPaths(const DesignFields& design) {
  MORTISE_RETURN_IF_ERROR(CheckCount(std::ssize(design.paths), "paths", kMaximumControls));
  std::set<std::string_view> ids;
  Eigen::Index total = 0;
  for (std::size_t i = 0; i < design.paths.size(); ++i) {
    const Path& path = design.paths[i];
    const std::string field = Entry("paths", i);
    MORTISE_RETURN_IF_ERROR(CheckOwnName(path.id, field + ".id", ids));
    if (path.nodes.size() < 2) return InvalidField(field + ".nodes", "must be at least two");
    MORTISE_RETURN_IF_ERROR(CheckTotal(total, std::ssize(path.nodes), field + ".nodes"));
    total += std::ssize(path.nodes);
    for (const int node : path.nodes) {
      if (node >= 0 && node < design.nodes.cols()) continue;
      return InvalidField(field + ".nodes", "names a node that is not there");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckWays(const DesignFields& design) {
  MORTISE_RETURN_IF_ERROR(CheckCount(std::ssize(design.ways), "ways", kMaximumControls));
  const auto points = std::ssize(design.control_points);
  Eigen::Index total = 0;
  for (std::size_t i = 0; i < design.ways.size(); ++i) {
    const ControlWay& way = design.ways[i];
    const std::string field = Entry("ways", i);
    if (way.edge.empty()) return InvalidField(field + ".edge", "must not be empty");
    MORTISE_RETURN_IF_ERROR(CheckName(way.edge, field + ".edge"));
    for (const auto& [end, name] : {std::pair(way.from, ".from"), std::pair(way.to, ".to")}) {
      if (end >= 0 && end < points) continue;
      return InvalidField(field + name, "is a control point that is not there");
    }
    MORTISE_RETURN_IF_ERROR(CheckTotal(total, way.positions.cols(), field + ".positions"));
    total += way.positions.cols();
    if (way.positions.cols() >= 2 && way.positions.allFinite()) continue;
    return InvalidField(field + ".positions", "must be at least two, and finite");
  }
  return absl::OkStatus();
}

absl::Status CheckField(const Field& field, const DesignFields& design, const std::string& place) {
  if (field.name.empty()) return InvalidField(place + ".name", "must not be empty");
  MORTISE_RETURN_IF_ERROR(CheckName(field.name, place + ".name"));
  MORTISE_RETURN_IF_ERROR(CheckName(field.unit, place + ".unit"));
  MORTISE_RETURN_IF_ERROR(CheckName(field.load_case, place + ".load_case"));
  if (field.values.rows() < 1 || field.values.rows() > kMaximumComponents) {
    return InvalidField(place + ".values",
                        absl::StrCat("must have 1 to ", kMaximumComponents, " components"));
  }
  const bool of_nodes = field.place == FieldPlace::kNodes;
  const Eigen::Index count = of_nodes ? design.nodes.cols() : design.tetrahedra.cols();
  if (field.values.cols() != count) {
    return InvalidField(place + ".values",
                        absl::StrCat("has ", field.values.cols(), " entries for the ", count,
                                     of_nodes ? " nodes" : " tetrahedra"));
  }
  if (field.values.allFinite()) return absl::OkStatus();
  return InvalidField(place + ".values", "must be finite");
}

absl::Status CheckFields(const DesignFields& design) {
  std::set<std::pair<std::string_view, std::string_view>> names;
  for (std::size_t i = 0; i < design.fields.size(); ++i) {
    const Field& field = design.fields[i];
    const std::string place = Entry("fields", i);
    MORTISE_RETURN_IF_ERROR(CheckField(field, design, place));
    if (names.emplace(field.name, field.load_case).second) continue;
    return InvalidField(place, absl::StrCat("'", field.name, "' is there twice in load case '",
                                            field.load_case, "'"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Check(const DesignFields& design) {
  MORTISE_RETURN_IF_ERROR(CheckCount(design.nodes.cols(), "nodes"));
  if (!design.nodes.allFinite()) return InvalidField("nodes", "must be finite");
  std::set<std::string_view> parts;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckOwnName(design.parts[i], Entry("parts", i), parts));
  }
  MORTISE_RETURN_IF_ERROR(CheckTetrahedra(design));
  MORTISE_RETURN_IF_ERROR(CheckTriangles(design));
  MORTISE_RETURN_IF_ERROR(CheckRegions(design));
  MORTISE_RETURN_IF_ERROR(CheckControlPoints(design));
  MORTISE_RETURN_IF_ERROR(CheckPaths(design));
  MORTISE_RETURN_IF_ERROR(CheckWays(design));
  return CheckFields(design);
}

}  // namespace mortise::fields
