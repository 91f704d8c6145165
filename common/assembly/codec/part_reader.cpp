#include "common/assembly/codec/part_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/design/field_checks.h"
#include "common/files/axis_codec.h"
#include "common/messages/vector_codec.h"

namespace mortise::parametric {
namespace {

constexpr int kMaxRepeat = 1000;
constexpr int kMaxPriority = 1000;
// Of the drawn size, what a part without an item may measure.
constexpr double kMinGrowth = 0.5;
constexpr double kMaxGrowth = 2;

// Which axis of the design each of the item's three lies along; nothing, and a finding, if two
// would lie along one.
std::optional<std::array<Axis, 3>> ItemAxes(const v1::AssemblyPart& part, const std::string& field,
                                            std::vector<FieldViolation>& findings) {
  const auto axis_of = [&](v1::Axis axis, Axis usual, const char* name) -> std::optional<Axis> {
    if (axis == v1::AXIS_UNSPECIFIED) return usual;
    const auto known = AxisFromProto(axis, absl::StrCat(field, name));
    if (known.ok()) return *known;
    findings.push_back({absl::StrCat(field, name), "must be X, Y or Z"});
    return std::nullopt;
  };
  const auto length = axis_of(part.length_axis(), Axis::kX, ".length_axis");
  const auto thickness = axis_of(part.thickness_axis(), Axis::kZ, ".thickness_axis");
  if (!length || !thickness) return std::nullopt;
  if (*length == *thickness) {
    findings.push_back(
        {field + ".thickness_axis", "is the length_axis too; unspecified, they are Z and X"});
    return std::nullopt;
  }
  const int width = 3 - static_cast<int>(*length) - static_cast<int>(*thickness);
  return std::array<Axis, 3>{*length, static_cast<Axis>(width), *thickness};
}

// Limits along the design's axes, and the size where it is left to the item.
void ApplyItem(const Item& item, const std::array<Axis, 3>& axes, AssemblyPart& part,
               Eigen::Vector3d& size) {
  part.item_axes = axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const ItemDimension& dimension = item.dimensions[i];
    const auto axis = static_cast<std::size_t>(axes[i]);
    const bool is_fixed = dimension.process == Process::kNone;
    part.limits[axis] = is_fixed ? SizeLimits{dimension.size, dimension.size}
                                 : SizeLimits{dimension.minimum, dimension.maximum};
    auto& along = size[static_cast<Eigen::Index>(axis)];
    if (is_fixed && along == 0) along = dimension.size;
  }
}

// What a part may measure of which nobody says what it is made of.
void ApplyDrawnSize(const Eigen::Vector3d& size, AssemblyPart& part) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double drawn = size[static_cast<Eigen::Index>(axis)];
    part.limits[axis] = part.connecting ? SizeLimits{drawn, drawn}
                                        : SizeLimits{kMinGrowth * drawn, kMaxGrowth * drawn};
  }
}

// Whether steps along one direction of a grid lead to where steps along the other do.
bool Coincide(const v1::Repeat& first, const v1::Repeat& second) {
  constexpr double kSameStep = 1e-9;
  const Eigen::Vector3d one = VectorFromProto(first.offset()),
                        other = VectorFromProto(second.offset());
  const double share = one.dot(other) / other.squaredNorm();  // of `other` that `one` is
  if ((one - share * other).norm() > kSameStep * one.norm()) return false;
  for (int steps = 1; steps < first.count(); ++steps) {
    const double there = std::abs(steps * share);
    if (std::round(there) >= second.count()) return false;
    if (std::abs(there - std::round(there)) <= kSameStep * there) return true;
  }
  return false;
}

}  // namespace

PartReader::Places PartReader::Repetitions(const v1::AssemblyPart& part, const std::string& field,
                                           std::vector<FieldViolation>& findings) {
  Places places = {{"", Eigen::Vector3d::Zero()}};
  if (part.repeat_size() > 2) {
    findings.push_back({field + ".repeat", "has at most two directions"});
    return places;
  }
  for (int r = 0; r < part.repeat_size(); ++r) {
    const v1::Repeat& repeat = part.repeat(r);
    const std::string place = absl::StrCat(field, ".repeat[", r, "]");
    const Eigen::Vector3d offset = VectorFromProto(repeat.offset());
    if (repeat.count() < 2 || repeat.count() > kMaxRepeat) {
      findings.push_back({place + ".count", absl::StrCat("must be 2 to ", kMaxRepeat)});
      return places;
    }
    if (!offset.allFinite() || offset.isZero()) {
      findings.push_back({place + ".offset", "must be finite and not 0"});
      return places;
    }
    if (r == 1 && Coincide(part.repeat(0), repeat)) {
      findings.push_back({place + ".offset", "puts parts where repeat[0] has put some"});
      return places;
    }
    Places more;
    for (const auto& [name, from] : places) {
      for (int i = 0; i < repeat.count(); ++i) {
        more.emplace_back(absl::StrCat(name, r == 0 ? " " : ".", i + 1), from + i * offset);
      }
    }
    places = std::move(more);
    if (places.size() > kMaxAssemblyParts) break;
  }
  return places;
}

void PartReader::Read(const v1::AssemblyPart& message, const std::string& field,
                      AssemblyDrawing& drawing) {
  CheckAssemblyName(field + ".name", message.name(), findings_);
  CheckTitle(field + ".title", message.title(), findings_);
  AssemblyPart part;
  part.item = message.item();
  part.group = groups_.Find(message.group(), field + ".group");
  part.connecting = message.role() == v1::AssemblyPart::CONNECTING;
  if (!v1::AssemblyPart::Role_IsValid(message.role())) {
    findings_.push_back({field + ".role", "must be PRINCIPAL or CONNECTING"});
  }
  if (message.priority() < 0 || message.priority() > kMaxPriority) {
    findings_.push_back({field + ".priority", absl::StrCat("must be 0 to ", kMaxPriority)});
  }
  ReadPlanes(message, field, part);
  Eigen::Vector3d size = VectorFromProto(message.size());
  const Item* const item = FindItem(items_, message.item());
  const bool has_item = !message.item().empty();
  if (has_item && item == nullptr) {
    findings_.push_back({field + ".item", absl::StrCat("there is no item '", message.item(), "'")});
  }
  const auto axes = ItemAxes(message, field, findings_);
  if (item != nullptr && axes) ApplyItem(*item, *axes, part, size);
  if (!has_item) ApplyDrawnSize(size, part);
  if (!has_item && axes) part.item_axes = *axes;
  if (message.has_color()) ReadColor(message.color(), field + ".color", part);
  if (axes) shapes_.Read(message, field, item, size, part);
  // Without its item, size and limits of a part would be found wrong again and again.
  const bool complete = (item != nullptr || !has_item) && axes && part.group >= 0;
  const Places places = Repetitions(message, field, findings_);
  CheckIncomplete(message.name(), field, complete);
  if (complete) AddAll(message, field, part, size, places, drawing);
}

void PartReader::ReadPlanes(const v1::AssemblyPart& message, const std::string& field,
                            AssemblyPart& part) {
  std::set<std::string> names;
  for (int i = 0; i < message.prominent_planes_size(); ++i) {
    const v1::ProminentPlane& plane = message.prominent_planes(i);
    const std::string place = absl::StrCat(field, ".prominent_planes[", i, "]");
    CheckAssemblyName(place + ".name", plane.name(), findings_);
    if (!names.insert(plane.name()).second) {
      findings_.push_back({place + ".name", absl::StrCat("'", plane.name(), "' occurs twice")});
    }
    const auto axis = AxisFromProto(plane.axis(), place + ".axis");
    if (!axis.ok()) {
      findings_.push_back({place + ".axis", "must be X, Y or Z"});
      continue;
    }
    part.prominent_planes.push_back({plane.name(), *axis, plane.position()});
  }
}

void PartReader::ReadColor(const v1::Vector3& color, const std::string& field, AssemblyPart& part) {
  part.color = VectorFromProto(color);
  if (!(part.color->minCoeff() >= 0 && part.color->maxCoeff() <= 1)) {
    findings_.push_back({field, "must be three numbers between 0 and 1"});
  }
}

void PartReader::CheckIncomplete(const std::string& name, const std::string& field, bool complete) {
  const auto [known, is_new] = complete_.emplace(name, complete);
  if (is_new || name.empty()) return;
  if (!complete || !known->second) {
    findings_.push_back({field + ".name", absl::StrCat("'", name, "' occurs twice")});
  }
  known->second = known->second && complete;
}

void PartReader::AddAll(const v1::AssemblyPart& message, const std::string& field,
                        const AssemblyPart& first, const Eigen::Vector3d& size,
                        const Places& places, AssemblyDrawing& drawing) {
  const Eigen::Vector3d position = VectorFromProto(message.position());
  for (const auto& [suffix, offset] : places) {
    if (drawing.assembly.parts.size() == kMaxAssemblyParts) {
      if (!full_) findings_.push_back({"parts", absl::StrCat("are more than ", kMaxAssemblyParts)});
      full_ = true;
      return;
    }
    AssemblyPart part = first;
    part.name = message.name() + suffix;
    part.box.minimum = position + offset;
    part.box.maximum = part.box.minimum + size;
    for (ProminentPlane& plane : part.prominent_planes) {
      plane.position += offset[static_cast<Eigen::Index>(plane.axis)];
    }
    AddPlanesOfShape(part);
    drawing.assembly.parts.push_back(std::move(part));
    drawing.part_fields.push_back(field);
  }
}

}  // namespace mortise::parametric
