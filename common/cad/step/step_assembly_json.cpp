#include "common/cad/step/step_assembly_json.h"

#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

using Json = nlohmann::json;

Json ToNumbers(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

// The upper three rows, row by row.
Json ToNumbers(const Eigen::Isometry3d& placement) {
  Json numbers = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) numbers.push_back(placement.matrix()(row, column));
  }
  return numbers;
}

Json ToNumbers(const std::optional<Eigen::Vector3d>& color) {
  return color ? ToNumbers(*color) : Json();
}

Eigen::Vector3d VectorFrom(const Json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

Eigen::Isometry3d PlacementFrom(const Json& numbers) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < 12; ++i) {
    placement.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) =
        numbers.at(i).get<double>();
  }
  return placement;
}

std::optional<Eigen::Vector3d> ColorFrom(const Json& numbers) {
  if (numbers.is_null()) return std::nullopt;
  return VectorFrom(numbers);
}

// Column by column.
template <class Matrix>
Json ToNumbers(const Matrix& matrix, Eigen::Index size) {
  return std::vector<typename Matrix::Scalar>(matrix.data(), matrix.data() + size);
}

template <class Matrix>
void MatrixFrom(const Json& json, Eigen::Index rows, Matrix& matrix) {
  const auto numbers = json.get<std::vector<typename Matrix::Scalar>>();
  matrix.resize(rows, static_cast<Eigen::Index>(numbers.size()) / rows);
  std::copy_n(numbers.begin(), matrix.size(), matrix.data());
}

Json ToJson(const mesh::DrawnShape& shape) {
  Json names = Json::array();
  for (const std::vector<std::string>& face : shape.face_names) names.push_back(face.front());
  return {{"size", ToNumbers(shape.size)},
          {"volume", shape.volume},
          {"deflection", shape.deflection},
          {"fractions", ToNumbers(shape.fractions, shape.fractions.size())},
          {"triangles", ToNumbers(shape.triangles, shape.triangles.size())},
          {"triangle_face", ToNumbers(shape.triangle_face, shape.triangle_face.size())},
          {"face_names", names},
          {"brep", absl::Base64Escape(shape.brep)}};
}

mesh::DrawnShape ShapeFrom(const Json& json) {
  mesh::DrawnShape shape;
  shape.size = VectorFrom(json.at("size"));
  shape.volume = json.at("volume");
  shape.deflection = json.at("deflection");
  MatrixFrom(json.at("fractions"), 3, shape.fractions);
  MatrixFrom(json.at("triangles"), 3, shape.triangles);
  const auto faces = json.at("triangle_face").get<std::vector<int>>();
  shape.triangle_face =
      Eigen::Map<const Eigen::VectorXi>(faces.data(), static_cast<Eigen::Index>(faces.size()));
  for (const Json& name : json.at("face_names")) shape.face_names.push_back({name});
  absl::Base64Unescape(json.at("brep").get<std::string>(), &shape.brep);
  mesh::DeriveFaces(shape);
  return shape;
}

StepAssembly Parse(const Json& json) {
  StepAssembly assembly;
  assembly.name = json.at("name");
  assembly.schema = json.at("schema");
  assembly.length_unit = json.at("length_unit");
  for (const Json& group : json.at("groups")) {
    assembly.groups.push_back(
        {group.at("name"), group.at("parent"), PlacementFrom(group.at("placement"))});
  }
  for (const Json& product : json.at("products")) {
    assembly.products.push_back({product.at("name"), std::nullopt, ColorFrom(product.at("color")),
                                 product.at("scale"), product.at("is_mirrored")});
  }
  for (const Json& entry : json.at("parts")) {
    StepPart part;
    part.name = entry.at("name");
    part.drawn_name = entry.at("drawn_name");
    part.group = entry.at("group");
    part.product = entry.at("product");
    part.placement = PlacementFrom(entry.at("placement"));
    part.color = ColorFrom(entry.at("color"));
    part.volume = entry.at("volume");
    part.faces = entry.at("faces");
    part.minimum = VectorFrom(entry.at("minimum"));
    part.maximum = VectorFrom(entry.at("maximum"));
    part.is_box = entry.at("is_box");
    part.shape = entry.at("shape");
    part.faults = entry.at("faults").get<std::vector<std::string>>();
    assembly.parts.push_back(std::move(part));
  }
  for (const Json& shape : json.at("shapes")) assembly.shapes.push_back(ShapeFrom(shape));
  for (const Json& leaf : json.at("leaves")) {
    assembly.leaves.push_back({leaf.at("name"), leaf.at("drawn_name"), leaf.at("product"),
                               leaf.at("group"), leaf.at("is_surface")});
  }
  assembly.notes = json.at("notes").get<std::vector<std::string>>();
  return assembly;
}

}  // namespace

std::string ToJson(const StepAssembly& assembly) {
  Json json = {
      {"name", assembly.name},   {"schema", assembly.schema}, {"length_unit", assembly.length_unit},
      {"groups", Json::array()}, {"products", Json::array()}, {"parts", Json::array()},
      {"leaves", Json::array()}, {"shapes", Json::array()},   {"notes", assembly.notes}};
  for (const StepGroup& group : assembly.groups) {
    json["groups"].push_back({{"name", group.name},
                              {"parent", group.parent},
                              {"placement", ToNumbers(group.placement)}});
  }
  for (const StepProduct& product : assembly.products) {
    json["products"].push_back({{"name", product.name},
                                {"color", ToNumbers(product.color)},
                                {"scale", product.scale},
                                {"is_mirrored", product.is_mirrored}});
  }
  for (const StepPart& part : assembly.parts) {
    json["parts"].push_back({{"name", part.name},
                             {"drawn_name", part.drawn_name},
                             {"group", part.group},
                             {"product", part.product},
                             {"placement", ToNumbers(part.placement)},
                             {"color", ToNumbers(part.color)},
                             {"volume", part.volume},
                             {"faces", part.faces},
                             {"minimum", ToNumbers(part.minimum)},
                             {"maximum", ToNumbers(part.maximum)},
                             {"is_box", part.is_box},
                             {"shape", part.shape},
                             {"faults", part.faults}});
  }
  for (const mesh::DrawnShape& shape : assembly.shapes) json["shapes"].push_back(ToJson(shape));
  for (const StepLeaf& leaf : assembly.leaves) {
    json["leaves"].push_back({{"name", leaf.name},
                              {"drawn_name", leaf.drawn_name},
                              {"product", leaf.product},
                              {"group", leaf.group},
                              {"is_surface", leaf.is_surface}});
  }
  // Names may be in another encoding than they claim.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

absl::StatusOr<StepAssembly> StepAssemblyFromJson(std::string_view text) {
  try {
    return Parse(Json::parse(text));
  } catch (const Json::exception& failure) {
    return KernelFailure("reading STEP", failure.what());
  }
}

}  // namespace mortise::cad
