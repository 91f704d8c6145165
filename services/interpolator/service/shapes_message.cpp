#include "services/interpolator/service/shapes_message.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>

namespace mortise::interpolator {
namespace {

using Field = v1::MapShapes::Field;

bool IsOf(const Field& field, const FieldKind& kind) {
  return field.name() == kind.name && field.load_case() == kind.load_case;
}

// The place of a field among those of a structure, or -1.
int FindField(const ShapedStructure& structure, const Field& field) {
  const auto found = std::ranges::find_if(structure.fields,
                                          [&](const FieldKind& kind) { return IsOf(field, kind); });
  return found == structure.fields.end() ? -1 : static_cast<int>(found - structure.fields.begin());
}

// Adds the fields of this name that any structure has.
void AddFields(const std::string& name, const std::vector<ShapedStructure>& structures,
               v1::MapShapes& shapes) {
  for (const ShapedStructure& structure : structures) {
    for (const FieldKind& kind : structure.fields) {
      const auto is_same = [&](const Field& field) { return IsOf(field, kind); };
      if (kind.name != name || std::ranges::any_of(shapes.fields(), is_same)) continue;
      Field& field = *shapes.add_fields();
      field.set_name(kind.name);
      field.set_unit(kind.unit);
      field.set_load_case(kind.load_case);
      field.set_components(kind.components);
      field.set_of_elements(kind.place == fields::FieldPlace::kElements);
      field.set_minimum(std::numeric_limits<double>::infinity());
      field.set_maximum(-std::numeric_limits<double>::infinity());
    }
  }
}

// Figures of one structure, beside `share` of those of all that have been added.
template <typename Message>
void AddErrors(const Spread& largest, double mean, double share, Message& to) {
  to.set_largest_error(std::max(to.largest_error(), largest.largest));
  to.set_largest_99_error(std::max(to.largest_99_error(), largest.of_99));
  to.set_mean_error(to.mean_error() + share * mean);
}

void AddStructure(const ShapedStructure& structure, double share, v1::MapShapes& shapes) {
  for (const ShapedStructure::Mesh& mesh : structure.meshes) {
    shapes.set_nodes(std::max(shapes.nodes(), mesh.nodes));
    shapes.set_triangles(std::max(shapes.triangles(), mesh.triangles));
    shapes.set_tetrahedra(std::max(shapes.tetrahedra(), mesh.tetrahedra));
    for (const std::string& region : mesh.regions) {
      if (std::ranges::count(shapes.regions(), region) == 0) shapes.add_regions(region);
    }
  }
  for (const auto& [place, shape] : structure.shapes) {
    shapes.set_size(std::max(shapes.size(), shape.size));
    shapes.set_rounding(std::max(shapes.rounding(), shape.rounding));
    shapes.set_inverted_tetrahedra(shapes.inverted_tetrahedra() + shape.inverted);
  }
  shapes.set_meshes(shapes.meshes() + static_cast<int>(structure.meshes.size()));
  shapes.set_shapes(shapes.shapes() + static_cast<std::int64_t>(structure.shapes.size()));
  shapes.set_unmapped(shapes.unmapped() + structure.unmapped);
  AddErrors(structure.largest.shape, structure.mean.shape.mean, share, shapes);
  for (Field& field : *shapes.mutable_fields()) {
    const int f = FindField(structure, field);
    if (f < 0) continue;
    const auto at = static_cast<std::size_t>(f);
    field.set_minimum(std::min(field.minimum(), structure.ranges[at].minimum));
    field.set_maximum(std::max(field.maximum(), structure.ranges[at].maximum));
    AddErrors(structure.largest.fields[at], structure.mean.fields[at].mean, share, field);
  }
}

// Floors as shares of size and range, as they are given.
void AddNoise(const v1::MapSpecification::ShapeChoice& wanted, const MeshNoise& noise,
              v1::MapShapes& shapes) {
  shapes.set_noise_floor(wanted.noise_floor());
  if (noise.shape && shapes.size() > 0) {
    shapes.set_noise_floor(*noise.shape / shapes.size());
    shapes.set_noise_estimated(true);
  }
  for (Field& field : *shapes.mutable_fields()) {
    for (const auto& given : wanted.fields()) {
      if (given.name() == field.name()) field.set_noise_floor(given.noise_floor());
    }
    const double range = field.maximum() - field.minimum();
    const auto floor = noise.OfFieldNamed(field.name(), field.load_case());
    if (!floor || !(range > 0)) continue;
    field.set_noise_floor(*floor / range);
    field.set_noise_estimated(true);
  }
}

}  // namespace

v1::MapShapes MakeShapes(const v1::MapSpecification& specification,
                         const std::vector<ShapedStructure>& structures, const MeshNoise& noise,
                         std::int64_t bytes) {
  v1::MapShapes shapes;
  shapes.set_geometry(specification.shape().geometry());
  for (const auto& field : specification.shape().fields()) {
    AddFields(field.name(), structures, shapes);
  }
  double elements = 0;
  for (const ShapedStructure& structure : structures) {
    elements += static_cast<double>(structure.element_mesh.size());
  }
  for (const ShapedStructure& structure : structures) {
    AddStructure(structure, static_cast<double>(structure.element_mesh.size()) / elements, shapes);
  }
  AddNoise(specification.shape(), noise, shapes);
  shapes.set_bytes(bytes);
  return shapes;
}

StoredShapes ToStored(const ShapedStructure& structure, const v1::MapShapes& shapes) {
  const auto elements = static_cast<Eigen::Index>(structure.element_mesh.size());
  StoredShapes stored;
  stored.element_meshes = structure.element_mesh;
  for (const ShapedStructure::Mesh& mesh : structure.meshes) {
    stored.meshes.push_back({mesh.digest, {}});
  }
  for (const auto& [place, shape] : structure.shapes) {
    stored.meshes[static_cast<std::size_t>(place.first)].shapes[place.second] = shape.digest;
  }
  stored.shape_errors = Eigen::VectorXd::Zero(elements);
  stored.field_errors = Eigen::MatrixXd::Zero(shapes.fields_size(), elements);
  for (Eigen::Index e = 0; e < elements; ++e) {
    const ShapedStructure::Errors& errors = structure.element_errors[static_cast<std::size_t>(e)];
    stored.shape_errors[e] = errors.shape.largest;
    for (int f = 0; f < shapes.fields_size(); ++f) {
      const int own = FindField(structure, shapes.fields(f));
      // Those that are cut off have none.
      if (own < 0 || static_cast<std::size_t>(own) >= errors.fields.size()) continue;
      stored.field_errors(f, e) = errors.fields[static_cast<std::size_t>(own)].largest;
    }
  }
  return stored;
}

std::int64_t BytesOf(const std::vector<ShapedStructure>& structures) {
  std::map<std::string, std::int64_t> files;
  for (const ShapedStructure& structure : structures) {
    for (const ShapedStructure::Mesh& mesh : structure.meshes) files[mesh.digest] = mesh.bytes;
    for (const auto& [place, shape] : structure.shapes) files[shape.digest] = shape.bytes;
  }
  std::int64_t bytes = 0;
  for (const auto& [digest, size] : files) bytes += size;
  return bytes;
}

}  // namespace mortise::interpolator
