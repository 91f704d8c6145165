#include "services/interpolator/shapes/field_transfer.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/mapping/nearest_place.h"
#include "services/interpolator/shapes/element_grid.h"

namespace mortise::interpolator {
namespace {

constexpr double kRounding = 1e-9;  // of the design's size: what lies outside by less does not

std::string NameOf(const FieldKind& kind) {
  std::string name = absl::StrCat("'", kind.name, "'");
  if (!kind.load_case.empty()) absl::StrAppend(&name, " of load case '", kind.load_case, "'");
  return name;
}

// Nodes of a design, each with its share: as many as a tetrahedron has.
struct Shares {
  Eigen::Vector4i nodes = Eigen::Vector4i::Zero();
  Eigen::Vector4d shares = Eigen::Vector4d::Zero();
};

Eigen::Matrix4Xi CornersIn(const Eigen::MatrixXi& tetrahedra) {
  if (tetrahedra.cols() == 0) return Eigen::Matrix4Xi(4, 0);
  return tetrahedra.topRows(4);
}

Shares SharesOf(const Eigen::Ref<const Eigen::Vector3i>& nodes, const Eigen::Vector3d& shares) {
  Shares place;
  place.nodes << nodes, nodes[0];
  place.shares << shares, 0;
  return place;
}

// Finds where points lie in a design. What only few of them need is made when it is needed.
class Locating {
 public:
  Locating(const fields::DesignFields& design, const OuterTriangles& outer)
      : design_(design), outer_(outer), tetrahedra_(CornersIn(design.tetrahedra)) {
    const Eigen::Matrix3Xd& nodes = design.nodes;
    rounding_ = kRounding * (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
  }

  struct Found {
    Shares place;
    int element = -1;
  };

  absl::StatusOr<Found> Find(const Eigen::Vector3d& point) {
    if (tetrahedra_.cols() > 0) {
      if (!grid_) grid_.emplace(design_.nodes, tetrahedra_);
      const ElementPlace place = grid_->Find(point);
      if (place.element >= 0) {
        return Found{{tetrahedra_.col(place.element), place.barycentric}, place.element};
      }
    }
    if (!surface_) {
      MORTISE_ASSIGN_OR_RETURN(surface_, NearestPlaces::Create({design_.nodes, outer_.triangles}));
    }
    MORTISE_ASSIGN_OR_RETURN(const TrianglePlace nearest, surface_->Find(point));
    const Eigen::Vector3i nodes = outer_.triangles.col(nearest.triangle);
    const Eigen::Matrix3d corners = design_.nodes(Eigen::all, nodes);
    const double distance = (corners * nearest.barycentric - point).norm();
    if (distance > rounding_) {
      ++outside;
      furthest = std::max(furthest, distance);
    }
    return Found{SharesOf(nodes, nearest.barycentric),
                 outer_.element[static_cast<std::size_t>(nearest.triangle)]};
  }

  int outside = 0;
  double furthest = 0;  // m

 private:
  const fields::DesignFields& design_;
  const OuterTriangles& outer_;
  const Eigen::Matrix4Xi tetrahedra_;
  double rounding_ = 0;
  std::optional<ElementGrid> grid_;
  std::optional<NearestPlaces> surface_;
};

absl::StatusOr<std::vector<Shares>> LocateNodes(const Eigen::Matrix3Xd& nodes,
                                                const std::vector<NodePlace>& places,
                                                Locating& locating) {
  std::vector<Shares> located;
  located.reserve(static_cast<std::size_t>(nodes.cols()));
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    const auto n = static_cast<std::size_t>(node);
    const bool is_known = n < places.size() && places[n].nodes.minCoeff() >= 0;
    if (is_known) {
      located.push_back(SharesOf(places[n].nodes, places[n].shares));
      continue;
    }
    MORTISE_ASSIGN_OR_RETURN(const Locating::Found found, locating.Find(nodes.col(node)));
    located.push_back(found.place);
  }
  return located;
}

Eigen::MatrixXd AtNodes(const Eigen::MatrixXd& values, const std::vector<Shares>& located) {
  Eigen::MatrixXd carried(values.rows(), static_cast<Eigen::Index>(located.size()));
  for (std::size_t n = 0; n < located.size(); ++n) {
    const Shares& place = located[n];
    auto value = carried.col(static_cast<Eigen::Index>(n));
    value.setZero();
    for (int k = 0; k < 4; ++k) value += place.shares[k] * values.col(place.nodes[k]);
  }
  return carried;
}

absl::StatusOr<std::vector<int>> LocateElements(const Eigen::Matrix3Xd& nodes,
                                                const CanonicalMesh& mesh, Locating& locating) {
  std::vector<int> located;
  located.reserve(static_cast<std::size_t>(mesh.tetrahedra.cols()));
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::Matrix<double, 3, 4> corners = nodes(Eigen::all, mesh.tetrahedra.col(e));
    MORTISE_ASSIGN_OR_RETURN(const Locating::Found found, locating.Find(corners.rowwise().mean()));
    located.push_back(found.element);
  }
  return located;
}

bool HasFieldOf(const CanonicalMesh& mesh, fields::FieldPlace place) {
  return std::any_of(mesh.fields.begin(), mesh.fields.end(),
                     [place](const FieldKind& kind) { return kind.place == place; });
}

}  // namespace

absl::StatusOr<std::vector<const fields::Field*>> MatchFields(const fields::DesignFields& design,
                                                              const CanonicalMesh& mesh) {
  std::vector<const fields::Field*> matched;
  for (const FieldKind& kind : mesh.fields) {
    const auto found =
        std::find_if(design.fields.begin(), design.fields.end(), [&](const fields::Field& field) {
          return field.name == kind.name && field.load_case == kind.load_case;
        });
    if (found == design.fields.end()) {
      return InvalidField("fields", absl::StrCat("lack ", NameOf(kind)));
    }
    const FieldKind theirs{found->name, found->unit, found->load_case, found->place,
                           static_cast<int>(found->values.rows())};
    if (!(theirs == kind)) {
      return InvalidField("fields", absl::StrCat("have ", NameOf(kind), " in another unit, of ",
                                                 "another number of components, or of nodes ",
                                                 "instead of elements or the other way round"));
    }
    matched.push_back(&*found);
  }
  return matched;
}

absl::StatusOr<CarriedFields> CarryFields(const std::vector<const fields::Field*>& matched,
                                          const fields::DesignFields& design,
                                          const OuterTriangles& outer, const CanonicalMesh& mesh,
                                          const Eigen::Matrix3Xd& nodes,
                                          const std::vector<NodePlace>& places) {
  Locating locating(design, outer);
  std::vector<Shares> at_nodes;
  std::vector<int> of_elements;
  if (HasFieldOf(mesh, fields::FieldPlace::kNodes)) {
    MORTISE_ASSIGN_OR_RETURN(at_nodes, LocateNodes(nodes, places, locating));
  }
  if (HasFieldOf(mesh, fields::FieldPlace::kElements)) {
    MORTISE_ASSIGN_OR_RETURN(of_elements, LocateElements(nodes, mesh, locating));
  }
  CarriedFields carried;
  for (const fields::Field* field : matched) {
    carried.fields.push_back(field->place == fields::FieldPlace::kNodes
                                 ? AtNodes(field->values, at_nodes)
                                 : Eigen::MatrixXd(field->values(Eigen::all, of_elements)));
  }
  carried.outside = locating.outside;
  carried.furthest = locating.furthest;
  return carried;
}

}  // namespace mortise::interpolator
