#include "common/assembly/model/bores.h"

#include <map>

namespace mortise::parametric {
namespace {

constexpr double kMaxPlay = 2;  // a bore against what lies in it

// A box of a shape, given from the middle of its own, as drawn in the design.
BoundingBox BoxOf(const AssemblyPart& part, const Eigen::Vector3d& middle,
                  const Eigen::Vector3d& size) {
  const Eigen::Vector3d factors = part.box.size().cwiseQuotient(part.shape->size);
  const Eigen::Vector3d center = part.box.center() + factors.cwiseProduct(middle);
  const Eigen::Vector3d half = factors.cwiseProduct(size) / 2;
  return {center - half, center + half};
}

BoundingBox BoxOf(const AssemblyPart& part, const mesh::RoundFace& face) {
  Eigen::Vector3d size = Eigen::Vector3d::Constant(2 * face.radius);
  size[face.axis] = face.length;
  return BoxOf(part, face.middle, size);
}

}  // namespace

std::vector<Bore> BoresOf(const AssemblyPart& part, ShapeFeatures& known) {
  std::vector<Bore> bores;
  for (const mesh::RoundFace& face : known.RoundFacesOf(*part.shape)) {
    if (!face.is_hollow || !face.is_whole) continue;
    bores.push_back({BoxOf(part, face), face.axis, -1});
  }
  for (const mesh::Countersink& countersink : known.CountersinksOf(*part.shape)) {
    Eigen::Vector3d size = Eigen::Vector3d::Constant(2 * countersink.radius);
    size[countersink.axis] = countersink.depth;
    bores.push_back({BoxOf(part, countersink.middle, size), countersink.axis, -1});
  }
  for (const mesh::Slot& slot : known.SlotsOf(*part.shape)) {
    bores.push_back({BoxOf(part, slot.middle, slot.size), slot.axis, slot.along});
  }
  return bores;
}

std::vector<BoundingBox> PinsOf(const AssemblyPart& part, int axis, ShapeFeatures& known) {
  std::vector<BoundingBox> pins;
  if (part.shape == nullptr) return pins;
  for (const mesh::RoundFace& face : known.RoundFacesOf(*part.shape)) {
    if (!face.is_hollow && face.is_whole && face.axis == axis) pins.push_back(BoxOf(part, face));
  }
  return pins;
}

bool Fills(double size, double bore) { return kMaxPlay * size >= bore; }

bool LiesIn(const BoundingBox& inner, const Bore& bore, double near) {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = inner.minimum[axis], high = inner.maximum[axis];
    if (axis == bore.axis) {
      if (low >= bore.box.maximum[axis] - near || high <= bore.box.minimum[axis] + near) {
        return false;
      }
      continue;
    }
    if (low < bore.box.minimum[axis] - near || high > bore.box.maximum[axis] + near) return false;
    if (axis != bore.slot_axis && !Fills(high - low, bore.box.size()[axis])) return false;
  }
  return true;
}

std::set<int> RowsInBoresOfOne(const Assembly& assembly, const std::vector<Element>& elements,
                               double tolerance, ShapeFeatures& known) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::set<int> rows;  // elements
  for (const AssemblyPart& bored : assembly.parts) {
    if (bored.shape == nullptr) continue;
    std::map<int, std::set<std::size_t>> within;  // parts, by their element
    for (const Bore& bore : BoresOf(bored, known)) {
      for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
        const AssemblyPart& part = assembly.parts[i];
        if (&part == &bored || !LiesIn(part.box, bore, tolerance)) continue;
        within[element_of[i]].insert(i);
      }
    }
    for (const auto& [element, parts] : within) {
      if (parts.size() > 1) rows.insert(element);
    }
  }
  std::set<int> found;
  for (const int row : rows) {
    const std::vector<int>& parts = elements[static_cast<std::size_t>(row)].parts;
    found.insert(parts.begin(), parts.end());
  }
  return found;
}

}  // namespace mortise::parametric
