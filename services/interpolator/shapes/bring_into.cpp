#include "services/interpolator/shapes/bring_into.h"

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fields/control_variables.h"
#include "services/interpolator/mapping/model_surface_map.h"
#include "services/interpolator/shapes/corner_design.h"
#include "services/interpolator/shapes/field_transfer.h"

namespace mortise::interpolator {
namespace {

// The nodes of a shape, and where those of the surface are between nodes of the design.
struct MappedNodes {
  Eigen::Matrix3Xd nodes;  // 3 × N, m
  std::vector<NodePlace> places;
};

template <typename First, typename Second>
bool AreSame(const First& a, const Second& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && (a.array() == b.array()).all();
}

bool HasSameElements(const fields::DesignFields& a, const fields::DesignFields& b) {
  return a.nodes.cols() == b.nodes.cols() && AreSame(a.tetrahedra, b.tetrahedra) &&
         AreSame(a.tetrahedron_part, b.tetrahedron_part) && AreSame(a.triangles, b.triangles) &&
         AreSame(a.triangle_back, b.triangle_back) && AreSame(a.triangle_front, b.triangle_front);
}

mesh::TetrahedralMesh ElementsOf(const CanonicalMesh& mesh) {
  mesh::TetrahedralMesh elements;
  elements.nodes = mesh.nodes;
  elements.tetrahedra = mesh.tetrahedra;
  elements.part = mesh.tetrahedron_part;
  elements.part_names = mesh.parts;
  elements.face_triangles.resize(3, 0);
  return elements;
}

// Renames what the mapping calls source and target.
absl::Status Renamed(const absl::Status& status) {
  ErrorDetail detail = DetailOf(status);
  for (const auto& [theirs, ours] :
       {std::pair<std::string_view, std::string_view>("source", "design"), {"target", "mesh"}}) {
    if (detail.field.starts_with(theirs)) detail.field.replace(0, theirs.size(), ours);
  }
  return detail.field.empty() ? status : WithDetail(status, detail);
}

// Returns the control variables of a design by place alone, as its nodes are not numbered as those
// of surfaces and canonical meshes are.
absl::StatusOr<mesh::ControlVariables> VariablesOf(const fields::DesignFields& design,
                                                   std::string_view field) {
  auto variables = fields::ControlVariablesOf(design);
  if (!variables.ok()) return UnderField(field, variables.status());
  for (mesh::ControlVariables::Point& point : variables->points) point.vertex = -1;
  return variables;
}

// A design with the mesh's own elements.
BroughtShape TakeOver(const fields::DesignFields& corners,
                      const std::vector<const fields::Field*>& matched, const CanonicalMesh& mesh) {
  BroughtShape brought;
  brought.is_identity = true;
  brought.shape.nodes = corners.nodes(Eigen::all, mesh.given_node);
  for (const fields::Field* field : matched) {
    const bool of_nodes = field->place == fields::FieldPlace::kNodes;
    brought.shape.fields.push_back(
        of_nodes ? Eigen::MatrixXd(field->values(Eigen::all, mesh.given_node)) : field->values);
  }
  return brought;
}

void AlignSigns(const CanonicalMesh& mesh, ConsistentShape& shape) {
  for (std::size_t f = 0; f < shape.fields.size(); ++f) {
    if (!HasArbitrarySign(mesh.fields[f])) continue;
    const double likeness = shape.fields[f].cwiseProduct(mesh.own_values[f]).sum();
    if (likeness < 0) shape.fields[f] *= -1;
  }
}

}  // namespace

int TurnedOver(const CanonicalMesh& mesh, const Eigen::Matrix3Xd& nodes) {
  const mesh::TetrahedralMesh elements = ElementsOf(mesh);
  const std::vector<int> inverted = InvertedElements(elements, nodes);
  if (inverted.empty()) return 0;
  const std::vector<int> own = InvertedElements(elements, mesh.nodes);
  return static_cast<int>(std::count_if(inverted.begin(), inverted.end(), [&](int element) {
    return !std::binary_search(own.begin(), own.end(), element);
  }));
}

// Makes what only depends on the mesh when it is first asked for.
class PreparedMesh::Mapping {
 public:
  Mapping(const CanonicalMesh& mesh, const MeshMapOptions& options)
      : mesh_(mesh), options_(options) {}

  // Places are between nodes of the design.
  absl::StatusOr<MappedNodes> Map(const fields::DesignFields& design, const OuterTriangles& outer) {
    MORTISE_RETURN_IF_ERROR(Prepare());
    return mapper_ ? MapElements(design) : MapSurfaceAlone(design, outer);
  }

 private:
  absl::Status Prepare() {
    const std::lock_guard lock(mutex_);
    if (!is_prepared_) prepared_ = PrepareOnce();
    is_prepared_ = true;
    return prepared_;
  }

  absl::Status PrepareOnce() {
    MORTISE_ASSIGN_OR_RETURN(mesh::ControlVariables variables, VariablesOf(mesh_.given, "target"));
    if (mesh_.element_count() == 0) {
      MORTISE_ASSIGN_OR_RETURN(
          surface_mapper_,
          ModelSurfaceMapper::Create({{mesh_.nodes, mesh_.triangles}, {}, {}, {}, variables},
                                     options_.layout));
      return absl::OkStatus();
    }
    MORTISE_ASSIGN_OR_RETURN(
        mapper_, MeshMapper::Create({ElementsOf(mesh_), std::move(variables)}, options_));
    return absl::OkStatus();
  }

  absl::StatusOr<MappedNodes> MapElements(const fields::DesignFields& design) const {
    MORTISE_ASSIGN_OR_RETURN(mesh::ControlVariables variables, VariablesOf(design, "source"));
    MORTISE_ASSIGN_OR_RETURN(MeshMap map, mapper_->Map({ElementsOf(design), std::move(variables)}));
    MappedNodes mapped;
    mapped.places.resize(static_cast<std::size_t>(mesh_.surface_nodes));
    for (std::size_t v = 0; v < map.outer.node.size(); ++v) {
      mapped.places[static_cast<std::size_t>(map.outer.node[v])] = map.places[v];
    }
    mapped.nodes = std::move(map.nodes);
    return mapped;
  }

  absl::StatusOr<MappedNodes> MapSurfaceAlone(const fields::DesignFields& design,
                                              const OuterTriangles& outer) const {
    MORTISE_ASSIGN_OR_RETURN(const mesh::ControlVariables variables, VariablesOf(design, "source"));
    MORTISE_ASSIGN_OR_RETURN(
        ModelSurfaceMap map,
        surface_mapper_->Map({{design.nodes, outer.triangles}, {}, {}, outer.middles, variables}));
    return MappedNodes{std::move(map.positions), std::move(map.places)};
  }

  const CanonicalMesh& mesh_;
  const MeshMapOptions options_;
  std::mutex mutex_;
  bool is_prepared_ = false;
  absl::Status prepared_;
  std::unique_ptr<const MeshMapper> mapper_;  // or, of a surface alone,
  std::unique_ptr<const ModelSurfaceMapper> surface_mapper_;
};

PreparedMesh::PreparedMesh(std::shared_ptr<const CanonicalMesh> mesh, const MeshMapOptions& options)
    : mesh_(std::move(mesh)), mapping_(std::make_unique<Mapping>(*mesh_, options)) {}

PreparedMesh::~PreparedMesh() = default;

absl::StatusOr<BroughtShape> PreparedMesh::BringOther(const fields::DesignFields& design) const {
  if (design.parts.size() != mesh_->parts.size()) {
    return PreconditionFailed("TOPOLOGY_DIFFERS",
                              absl::StrCat("the design has ", design.parts.size(),
                                           " parts, the mesh of the map has ", mesh_->parts.size()),
                              "design.parts");
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<const fields::Field*> matched,
                           MatchFields(design, *mesh_));
  const OuterTriangles outer = FindOuterTriangles(design);
  auto mapped = mapping_->Map(design, outer);
  if (!mapped.ok()) return Renamed(mapped.status());
  MORTISE_ASSIGN_OR_RETURN(CarriedFields carried, CarryFields(matched, design, outer, *mesh_,
                                                              mapped->nodes, mapped->places));
  BroughtShape brought;
  brought.shape = {std::move(mapped->nodes), std::move(carried.fields)};
  brought.outside = carried.outside;
  brought.furthest = carried.furthest;
  return brought;
}

absl::StatusOr<BroughtShape> PreparedMesh::Bring(const fields::DesignFields& design) const {
  MORTISE_RETURN_IF_ERROR(fields::Check(design));
  const bool with_elements = mesh_->element_count() > 0;
  if (with_elements && design.tetrahedra.cols() == 0) {
    return InvalidField("tetrahedra", "must be there, as the mesh of the map has some");
  }
  const fields::DesignFields corners = CornersOf(design, with_elements);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<const fields::Field*> matched,
                           MatchFields(corners, *mesh_));
  BroughtShape brought;
  if (HasSameElements(corners, mesh_->given)) {
    brought = TakeOver(corners, matched, *mesh_);
  } else {
    // With the middles of quadratic elements, which say how its sides are curved.
    MORTISE_ASSIGN_OR_RETURN(
        brought, with_elements ? BringOther(design) : BringOther(WithoutElements(design)));
  }
  AlignSigns(*mesh_, brought.shape);
  brought.inverted = TurnedOver(*mesh_, brought.shape.nodes);
  return brought;
}

}  // namespace mortise::interpolator
