#include "services/interpolator/shapes/canonical_mesh.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "common/mesh/surface_check.h"
#include "services/interpolator/shapes/compressed_file.h"
#include "services/interpolator/shapes/corner_design.h"
#include "services/interpolator/shapes/space_order.h"

namespace mortise::interpolator {
namespace {

constexpr std::string_view kLetters = "MORTISEM";

// Makes a mesh of corners whose outer triangles have been found.
class MeshMaker {
 public:
  MeshMaker(fields::DesignFields corners, OuterTriangles outer)
      : outer_(std::move(outer)), has_elements_(corners.tetrahedra.cols() > 0) {
    mesh_.given = std::move(corners);
  }

  CanonicalMesh Make() {
    for (const fields::Field& field : mesh_.given.fields) {
      mesh_.fields.push_back({field.name, field.unit, field.load_case, field.place,
                              static_cast<int>(field.values.rows())});
    }
    OrderNodes();
    KeepOwnValues();
    mesh_.given.fields.clear();
    AddElements();
    AddTriangles();
    AddRegions();
    mesh_.parts = mesh_.given.parts;
    mesh_.is_closed = mesh::IsBalanced(mesh_.nodes, mesh_.triangles);
    mesh_.size = (mesh_.nodes.rowwise().maxCoeff() - mesh_.nodes.rowwise().minCoeff()).norm();
    return std::move(mesh_);
  }

 private:
  void OrderNodes() {
    const Eigen::Matrix3Xd& nodes = mesh_.given.nodes;
    std::vector<bool> is_outer(static_cast<std::size_t>(nodes.cols()), false);
    for (const int node : outer_.triangles.reshaped()) {
      is_outer[static_cast<std::size_t>(node)] = true;
    }
    std::vector<int> inside;
    for (int node = 0; node < static_cast<int>(nodes.cols()); ++node) {
      (is_outer[static_cast<std::size_t>(node)] ? mesh_.given_node : inside).push_back(node);
    }
    mesh_.surface_nodes = static_cast<int>(mesh_.given_node.size());
    SortInSpace(nodes, mesh_.given_node);
    SortInSpace(nodes, inside);
    if (has_elements_) {
      mesh_.given_node.insert(mesh_.given_node.end(), inside.begin(), inside.end());
    }
    mesh_.nodes = nodes(Eigen::all, mesh_.given_node);
    number_.assign(static_cast<std::size_t>(nodes.cols()), -1);
    for (std::size_t n = 0; n < mesh_.given_node.size(); ++n) {
      number_[static_cast<std::size_t>(mesh_.given_node[n])] = static_cast<int>(n);
    }
  }

  void KeepOwnValues() {
    for (std::size_t f = 0; f < mesh_.fields.size(); ++f) {
      Eigen::MatrixXd& own = mesh_.own_values.emplace_back();
      if (!HasArbitrarySign(mesh_.fields[f])) continue;
      const Eigen::MatrixXd& values = mesh_.given.fields[f].values;
      own = values(Eigen::all, mesh_.given_node).cast<float>().cast<double>();
    }
  }

  int Numbered(int given) const { return number_[static_cast<std::size_t>(given)]; }

  void AddElements() {
    const auto numbered = [this](int node) { return Numbered(node); };
    mesh_.tetrahedra = mesh_.given.tetrahedra.unaryExpr(numbered);
    mesh_.tetrahedron_part = mesh_.given.tetrahedron_part;
    mesh_.triangles = outer_.triangles.unaryExpr(numbered);
    mesh_.triangle_part = outer_.part;
  }

  void AddTriangles() {
    std::vector<int> inner;
    for (std::size_t t = 0; has_elements_ && t < outer_.outer_of.size(); ++t) {
      if (outer_.outer_of[t] < 0) inner.push_back(static_cast<int>(t));
    }
    const Eigen::MatrixXi given = mesh_.given.triangles(Eigen::all, inner);
    mesh_.inner_triangles = given.unaryExpr([this](int node) { return Numbered(node); });
    mesh_.inner_back = mesh_.given.triangle_back(inner);
    mesh_.inner_front = mesh_.given.triangle_front(inner);
  }

  void AddRegions() {
    for (const fields::Region& region : mesh_.given.regions) {
      fields::Region& outside = mesh_.regions.emplace_back(fields::Region{region.name, {}});
      for (const int triangle : region.triangles) {
        const int number = outer_.outer_of[static_cast<std::size_t>(triangle)];
        if (number >= 0) outside.triangles.push_back(number);
      }
    }
  }

  const OuterTriangles outer_;
  const bool has_elements_;
  std::vector<int> number_;  // of each given node; -1 of those left out
  CanonicalMesh mesh_;
};

}  // namespace

bool HasArbitrarySign(const FieldKind& kind) {
  return kind.name == "mode_shape" && kind.place == fields::FieldPlace::kNodes;
}

int CanonicalMesh::FindField(std::string_view name, std::string_view load_case) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldKind& kind) {
    return kind.name == name && kind.load_case == load_case;
  });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

absl::StatusOr<CanonicalMesh> CanonicalMesh::Create(const fields::DesignFields& design) {
  MORTISE_RETURN_IF_ERROR(fields::Check(design));
  fields::DesignFields corners = CornersOf(design);
  OuterTriangles outer = FindOuterTriangles(corners);
  if (outer.triangles.cols() == 0) return InvalidField("triangles", "must be some on the outside");
  return MeshMaker(std::move(corners), std::move(outer)).Make();
}

absl::StatusOr<std::string> WriteMesh(const CanonicalMesh& mesh) {
  fields::DesignFields design = mesh.given;
  for (std::size_t f = 0; f < mesh.fields.size(); ++f) {
    const FieldKind& kind = mesh.fields[f];
    fields::Field& field = design.fields.emplace_back();
    field.name = kind.name;
    field.unit = kind.unit;
    field.load_case = kind.load_case;
    field.place = kind.place;
    const bool of_nodes = kind.place == fields::FieldPlace::kNodes;
    field.values = Eigen::MatrixXd::Zero(kind.components,
                                         of_nodes ? design.nodes.cols() : design.tetrahedra.cols());
    if (!HasArbitrarySign(kind)) continue;
    for (Eigen::Index node = 0; node < mesh.nodes.cols(); ++node) {
      field.values.col(mesh.given_node[static_cast<std::size_t>(node)]) =
          mesh.own_values[f].col(node);
    }
  }
  MORTISE_ASSIGN_OR_RETURN(const std::string content, fields::WriteFields(design));
  return Compress(kLetters, content);
}

absl::StatusOr<CanonicalMesh> ReadMesh(std::string_view bytes) {
  MORTISE_ASSIGN_OR_RETURN(const std::string content,
                           Expand(kLetters, bytes, fields::kMaximumFileSize, "mesh"));
  const auto design = fields::ReadFields(content);
  if (!design.ok()) return UnderField("mesh", design.status());
  auto mesh = CanonicalMesh::Create(*design);
  if (!mesh.ok()) return UnderField("mesh", mesh.status());
  return mesh;
}

}  // namespace mortise::interpolator
