// Field-by-field conversion of materials and items.
#include <array>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/axis_codec.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {
namespace {

// The value; nothing, and what is wrong with it to the findings, if there is none.
template <typename Value>
std::optional<Value> Read(const absl::StatusOr<Value>& value,
                          std::vector<FieldViolation>& findings) {
  if (value.ok()) return *value;
  for (const FieldViolation& violation : AllViolationsOf(value.status())) {
    findings.push_back({violation.field, violation.message});
  }
  return std::nullopt;
}

void ReadDimensions(const v1::Item& message, Item& item, std::vector<FieldViolation>& findings) {
  std::array<bool, 3> given = {false, false, false};
  const std::size_t before = findings.size();
  for (int i = 0; i < message.dimensions_size(); ++i) {
    const v1::ItemDimension& dimension = message.dimensions(i);
    const std::string field = absl::StrCat("dimensions[", i, "]");
    const std::optional<Axis> axis =
        Read(AxisFromProto(dimension.axis(), absl::StrCat(field, ".axis")), findings);
    const std::optional<Process> process =
        Read(ProcessFromProto(dimension.process(), absl::StrCat(field, ".process")), findings);
    if (!axis) continue;
    const auto index = static_cast<std::size_t>(*axis);
    if (given[index]) findings.push_back({absl::StrCat(field, ".axis"), "is given twice"});
    given[index] = true;
    item.dimensions[index] = {dimension.size(),    process.value_or(Process::kNone),
                              dimension.minimum(), dimension.maximum(),
                              dimension.name(),    dimension.nominal()};
  }
  // Of an axis that is another's it is told already.
  const bool is_complete = given[0] && given[1] && given[2];
  if (!is_complete && findings.size() == before) {
    findings.push_back({"dimensions", "must hold one entry for each of X, Y and Z"});
  }
}

// The grain's axes may be left unsaid.
std::optional<Axis> ReadOptionalAxis(v1::Axis axis, const std::string& field,
                                     std::vector<FieldViolation>& findings) {
  if (axis == v1::AXIS_UNSPECIFIED) return std::nullopt;
  return Read(AxisFromProto(axis, field), findings);
}

std::string KindNames() {
  std::string names;
  const google::protobuf::EnumDescriptor& kinds = *v1::ItemKind_descriptor();
  for (int i = 1; i < kinds.value_count(); ++i) {
    absl::StrAppend(&names,
                    i == 1                         ? ""
                    : i + 1 == kinds.value_count() ? " or "
                                                   : ", ",
                    kinds.value(i)->name());
  }
  return names;
}

OrthotropicElasticity ElasticityFromProto(const v1::OrthotropicElasticity& message) {
  return {message.youngs_modulus_l(),  message.youngs_modulus_r(),  message.youngs_modulus_t(),
          message.shear_modulus_lr(),  message.shear_modulus_lt(),  message.shear_modulus_rt(),
          message.poissons_ratio_lr(), message.poissons_ratio_lt(), message.poissons_ratio_rt()};
}

void SetElasticity(const OrthotropicElasticity& elasticity, v1::OrthotropicElasticity& message) {
  message.set_youngs_modulus_l(elasticity.youngs_modulus_l);
  message.set_youngs_modulus_r(elasticity.youngs_modulus_r);
  message.set_youngs_modulus_t(elasticity.youngs_modulus_t);
  message.set_shear_modulus_lr(elasticity.shear_modulus_lr);
  message.set_shear_modulus_lt(elasticity.shear_modulus_lt);
  message.set_shear_modulus_rt(elasticity.shear_modulus_rt);
  message.set_poissons_ratio_lr(elasticity.poissons_ratio_lr);
  message.set_poissons_ratio_lt(elasticity.poissons_ratio_lt);
  message.set_poissons_ratio_rt(elasticity.poissons_ratio_rt);
}

void SetDimensions(const Item& item, v1::Item& message) {
  for (std::size_t i = 0; i < 3; ++i) {
    v1::ItemDimension& dimension = *message.add_dimensions();
    dimension.set_axis(static_cast<v1::Axis>(i + 1));
    dimension.set_size(item.dimensions[i].size);
    dimension.set_process(ProcessToProto(item.dimensions[i].process));
    dimension.set_minimum(item.dimensions[i].minimum);
    dimension.set_maximum(item.dimensions[i].maximum);
    dimension.set_name(item.dimensions[i].name);
    dimension.set_nominal(item.dimensions[i].nominal);
  }
}

void SetLists(const Item& item, v1::Item& message) {
  for (const ItemMeasure& measure : item.measures) {
    v1::ItemMeasure& added = *message.add_measures();
    added.set_name(measure.name);
    added.set_size(measure.size);
    added.set_minimum(measure.minimum);
    added.set_maximum(measure.maximum);
  }
  for (const StockSize& stock : item.stock_sizes) {
    v1::StockSize& added = *message.add_stock_sizes();
    added.set_length(stock.length);
    added.set_width(stock.width);
    if (stock.price) added.set_price(*stock.price);
  }
  for (const SupplierLink& link : item.more_suppliers) {
    v1::SupplierLink& added = *message.add_more_suppliers();
    added.set_supplier(link.supplier);
    added.set_url(link.url);
    added.set_number(link.number);
  }
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
  if (!v1::Process_IsValid(process)) {
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
  if (message.has_orthotropic()) material.orthotropic = ElasticityFromProto(message.orthotropic());
  if (message.has_grain()) material.grain = message.grain();
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
  if (material.orthotropic) SetElasticity(*material.orthotropic, *message.mutable_orthotropic());
  if (material.grain) message.set_grain(*material.grain);
  return message;
}

Item ReadItem(const v1::Item& message, std::vector<FieldViolation>& findings) {
  Item item;
  item.name = message.name();
  item.title = message.title();
  if (message.kind() == v1::ITEM_KIND_UNSPECIFIED || !v1::ItemKind_IsValid(message.kind())) {
    findings.push_back({"kind", "must be " + KindNames()});
  } else {
    item.kind = static_cast<ItemKind>(message.kind());
  }
  item.material = message.material();
  ReadDimensions(message, item, findings);
  item.price = {message.price().currency(), message.price().amount()};
  if (message.price_basis() < v1::PER_PIECE || message.price_basis() > v1::PER_VOLUME) {
    findings.push_back({"price_basis", "must be PER_PIECE or PER_VOLUME"});
  } else {
    item.price_basis = static_cast<PriceBasis>(message.price_basis());
  }
  item.price_date = message.price_date();
  item.supplier = message.supplier();
  item.supplier_url = message.supplier_url();
  item.supplier_number = message.supplier_number();
  item.revision = message.revision();
  item.price_is_example = message.price_is_example();
  item.standard = message.standard();
  item.designation = message.designation();
  item.shape = message.shape();
  for (const v1::ItemMeasure& measure : message.measures()) {
    item.measures.push_back({measure.name(), measure.size(), measure.minimum(), measure.maximum()});
  }
  for (const v1::StockSize& stock : message.stock_sizes()) {
    item.stock_sizes.push_back(
        {stock.length(), stock.width(),
         stock.has_price() ? std::optional<double>(stock.price()) : std::nullopt});
  }
  for (const v1::SupplierLink& link : message.more_suppliers()) {
    item.more_suppliers.push_back({link.supplier(), link.url(), link.number()});
  }
  item.grain_axis = ReadOptionalAxis(message.grain_axis(), "grain_axis", findings);
  item.radial_axis = ReadOptionalAxis(message.radial_axis(), "radial_axis", findings);
  return item;
}

absl::StatusOr<Item> FromProto(const v1::Item& message) {
  std::vector<FieldViolation> findings;
  Item item = ReadItem(message, findings);
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return item;
}

v1::Item ToProto(const Item& item) {
  v1::Item message;
  message.set_name(item.name);
  message.set_title(item.title);
  message.set_kind(static_cast<v1::ItemKind>(item.kind));
  message.set_material(item.material);
  SetDimensions(item, message);
  message.mutable_price()->set_currency(item.price.currency);
  message.mutable_price()->set_amount(item.price.amount);
  message.set_price_basis(static_cast<v1::PriceBasis>(item.price_basis));
  message.set_price_date(item.price_date);
  message.set_supplier(item.supplier);
  message.set_supplier_url(item.supplier_url);
  message.set_supplier_number(item.supplier_number);
  message.set_revision(item.revision);
  message.set_price_is_example(item.price_is_example);
  message.set_standard(item.standard);
  message.set_designation(item.designation);
  message.set_shape(item.shape);
  SetLists(item, message);
  if (item.grain_axis) message.set_grain_axis(AxisToProto(*item.grain_axis));
  if (item.radial_axis) message.set_radial_axis(AxisToProto(*item.radial_axis));
  return message;
}

}  // namespace mortise::parametric
