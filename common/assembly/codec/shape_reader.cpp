#include "common/assembly/codec/shape_reader.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::parametric {
namespace {

constexpr double kFixedSlack = 1e-3;  // m; a drawing's tolerance is at most that
constexpr double kSamePlane = 1e-6;   // m

}  // namespace

void ShapeReader::Read(const v1::AssemblyPart& message, const std::string& field, const Item* item,
                       const Eigen::Vector3d& size, AssemblyPart& part) {
  const bool is_own = !message.shape().empty();
  if (!is_own && (item == nullptr || item->shape.empty())) return;
  const std::string& name = is_own ? message.shape() : item->shape;
  const std::string place = field + (is_own ? ".shape" : ".item");
  const auto found = shapes_.find(name);
  if (found == shapes_.end()) {
    findings_.push_back({place, absl::StrCat("there is no shape '", name, "'")});
    return;
  }
  part.shape = is_own ? found->second : TurnedAs(*found->second, part.item_axes);
  if (item != nullptr) CheckFixed(*item, size, place, part);
}

std::shared_ptr<const mesh::DrawnShape> ShapeReader::TurnedAs(const mesh::DrawnShape& shape,
                                                              const std::array<Axis, 3>& axes) {
  const int x = static_cast<int>(axes[0]), z = static_cast<int>(axes[2]);
  auto& turned = turned_[{shape.name, 3 * x + z}];
  if (turned == nullptr) {
    turned = std::make_shared<const mesh::DrawnShape>(mesh::Turned(shape, x, z));
  }
  return turned;
}

void ShapeReader::CheckFixed(const Item& item, const Eigen::Vector3d& size,
                             const std::string& field, const AssemblyPart& part) {
  for (std::size_t i = 0; i < 3; ++i) {
    const ItemDimension& dimension = item.dimensions[i];
    if (dimension.process != Process::kNone) continue;
    const auto axis = static_cast<Eigen::Index>(part.item_axes[i]);
    const double drawn = part.shape->size[axis];
    // A size that differs from the item's is a finding by itself.
    if (std::abs(drawn - dimension.size) <= kFixedSlack || size[axis] != dimension.size) continue;
    const std::vector<std::string> lengths = ComparedMillimetres({drawn, dimension.size});
    findings_.push_back({field, absl::StrCat("the shape measures ", lengths[0], " mm along ",
                                             AxisName(part.item_axes[i]), ", where '", item.name,
                                             "' comes in ", lengths[1], " mm only")});
  }
}

void AddPlanesOfShape(AssemblyPart& part) {
  if (part.shape == nullptr) return;
  const std::size_t annotated = part.prominent_planes.size();
  for (const mesh::ShapePlane& plane : part.shape->planes) {
    const double position =
        part.box.center()[plane.axis] + plane.fraction * part.box.size()[plane.axis];
    const auto is_same = [&](const ProminentPlane& other) {
      return other.name == plane.name || (static_cast<int>(other.axis) == plane.axis &&
                                          std::abs(other.position - position) < kSamePlane);
    };
    const auto end = part.prominent_planes.begin() + static_cast<long>(annotated);
    if (std::any_of(part.prominent_planes.begin(), end, is_same)) continue;
    part.prominent_planes.push_back({plane.name, static_cast<Axis>(plane.axis), position});
  }
}

}  // namespace mortise::parametric
