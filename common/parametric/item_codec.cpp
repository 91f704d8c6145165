// Field-by-field conversion of materials and items.
#include <array>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/axis_codec.h"
#include "common/parametric/template_codec.h"

namespace mortise::parametric {
namespace {

absl::StatusOr<std::array<ItemDimension, 3>> DimensionsFromProto(const v1::Item& message) {
  std::array<ItemDimension, 3> dimensions;
  std::array<bool, 3> given = {false, false, false};
  for (int i = 0; i < message.dimensions_size(); ++i) {
    const v1::ItemDimension& dimension = message.dimensions(i);
    const std::string field = absl::StrCat("dimensions[", i, "]");
    MORTISE_ASSIGN_OR_RETURN(const Axis axis,
                             AxisFromProto(dimension.axis(), absl::StrCat(field, ".axis")));
    const auto index = static_cast<std::size_t>(axis);
    if (given[index]) return InvalidField(absl::StrCat(field, ".axis"), "is given twice");
    given[index] = true;
    MORTISE_ASSIGN_OR_RETURN(
        const Process process,
        ProcessFromProto(dimension.process(), absl::StrCat(field, ".process")));
    dimensions[index] = {dimension.size(), process, dimension.minimum(), dimension.maximum()};
  }
  if (!given[0] || !given[1] || !given[2]) {
    return InvalidField("dimensions", "must hold one entry for each of X, Y and Z");
  }
  return dimensions;
}

}  // namespace

absl::StatusOr<Axis> AxisFromProto(v1::Axis axis, const std::string& field) {
  switch (axis) {
    case v1::X:
      return Axis::kX;
    case v1::Y:
      return Axis::kY;
    case v1::Z:
      return Axis::kZ;
    default:
      return InvalidField(field, "must be X, Y or Z");
  }
}

v1::Axis AxisToProto(Axis axis) { return static_cast<v1::Axis>(static_cast<int>(axis) + 1); }

absl::StatusOr<Process> ProcessFromProto(v1::Process process, const std::string& field) {
  if (process < v1::PROCESS_UNSPECIFIED || process > v1::MILL) {
    return InvalidField(field, "is not a process that is known here");
  }
  return static_cast<Process>(process);
}

v1::Process ProcessToProto(Process process) { return static_cast<v1::Process>(process); }

absl::StatusOr<Material> FromProto(const v1::Material& message) {
  Material material;
  material.name = message.name();
  material.title = message.title();
  material.density = message.density();
  material.youngs_modulus = message.youngs_modulus();
  material.poissons_ratio = message.poissons_ratio();
  material.strength = message.strength();
  material.thermal_conductivity = message.thermal_conductivity();
  material.thermal_expansion = message.thermal_expansion();
  material.revision = message.revision();
  return material;
}

v1::Material ToProto(const Material& material) {
  v1::Material message;
  message.set_name(material.name);
  message.set_title(material.title);
  message.set_density(material.density);
  message.set_youngs_modulus(material.youngs_modulus);
  message.set_poissons_ratio(material.poissons_ratio);
  message.set_strength(material.strength);
  message.set_thermal_conductivity(material.thermal_conductivity);
  message.set_thermal_expansion(material.thermal_expansion);
  message.set_revision(material.revision);
  return message;
}

absl::StatusOr<Item> FromProto(const v1::Item& message) {
  Item item;
  item.name = message.name();
  item.title = message.title();
  if (message.kind() < v1::BOARD || message.kind() > v1::HARDWARE) {
    return InvalidField("kind", "must be BOARD, SHEET, DOWEL, SCREW or HARDWARE");
  }
  item.kind = static_cast<ItemKind>(message.kind());
  item.material = message.material();
  MORTISE_ASSIGN_OR_RETURN(item.dimensions, DimensionsFromProto(message));
  item.price = {message.price().currency(), message.price().amount()};
  if (message.price_basis() < v1::PER_PIECE || message.price_basis() > v1::PER_VOLUME) {
    return InvalidField("price_basis", "must be PER_PIECE or PER_VOLUME");
  }
  item.price_basis = static_cast<PriceBasis>(message.price_basis());
  item.price_date = message.price_date();
  item.supplier = message.supplier();
  item.supplier_url = message.supplier_url();
  item.supplier_number = message.supplier_number();
  item.revision = message.revision();
  return item;
}

v1::Item ToProto(const Item& item) {
  v1::Item message;
  message.set_name(item.name);
  message.set_title(item.title);
  message.set_kind(static_cast<v1::ItemKind>(item.kind));
  message.set_material(item.material);
  for (std::size_t i = 0; i < 3; ++i) {
    v1::ItemDimension* dimension = message.add_dimensions();
    dimension->set_axis(static_cast<v1::Axis>(i + 1));
    dimension->set_size(item.dimensions[i].size);
    dimension->set_process(ProcessToProto(item.dimensions[i].process));
    dimension->set_minimum(item.dimensions[i].minimum);
    dimension->set_maximum(item.dimensions[i].maximum);
  }
  message.mutable_price()->set_currency(item.price.currency);
  message.mutable_price()->set_amount(item.price.amount);
  message.set_price_basis(static_cast<v1::PriceBasis>(item.price_basis));
  message.set_price_date(item.price_date);
  message.set_supplier(item.supplier);
  message.set_supplier_url(item.supplier_url);
  message.set_supplier_number(item.supplier_number);
  message.set_revision(item.revision);
  return message;
}

}  // namespace mortise::parametric
