#include "common/cad/step_assembly_json.h"

#include <nlohmann/json.hpp>

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
    assembly.products.push_back({product.at("name"), std::nullopt, ColorFrom(product.at("color"))});
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
    part.minimum = VectorFrom(entry.at("minimum"));
    part.maximum = VectorFrom(entry.at("maximum"));
    part.is_box = entry.at("is_box");
    assembly.parts.push_back(std::move(part));
  }
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
      {"leaves", Json::array()}, {"notes", assembly.notes}};
  for (const StepGroup& group : assembly.groups) {
    json["groups"].push_back({{"name", group.name},
                              {"parent", group.parent},
                              {"placement", ToNumbers(group.placement)}});
  }
  for (const StepProduct& product : assembly.products) {
    json["products"].push_back({{"name", product.name}, {"color", ToNumbers(product.color)}});
  }
  for (const StepPart& part : assembly.parts) {
    json["parts"].push_back({{"name", part.name},
                             {"drawn_name", part.drawn_name},
                             {"group", part.group},
                             {"product", part.product},
                             {"placement", ToNumbers(part.placement)},
                             {"color", ToNumbers(part.color)},
                             {"volume", part.volume},
                             {"minimum", ToNumbers(part.minimum)},
                             {"maximum", ToNumbers(part.maximum)},
                             {"is_box", part.is_box}});
  }
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
