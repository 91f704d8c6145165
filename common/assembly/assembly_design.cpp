#include "common/assembly/assembly_design.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/design/compiled_template.h"
#include "common/design/polygon.h"

namespace mortise::parametric {
namespace {

constexpr int kSides = 24;  // of what is round

// Hollow sections are tubes too, but say a width.
bool HasDiameter(const Item& item) {
  return item.dimensions[1].name.find("diameter") != std::string::npos;
}

// The axis of the item about which it is round; nothing if it is not.
std::optional<Axis> RoundAbout(const Item& item) {
  switch (item.kind) {
    case ItemKind::kDowel:
    case ItemKind::kScrew:
    case ItemKind::kBolt:
    case ItemKind::kThreadedRod:
      return Axis::kX;
    case ItemKind::kTube:
      return HasDiameter(item) ? std::optional(Axis::kX) : std::nullopt;
    case ItemKind::kNut:
    case ItemKind::kWasher:
    case ItemKind::kBearing:
    case ItemKind::kWheel:
      return Axis::kZ;
    default:
      return std::nullopt;
  }
}

// The axes of a prism's plane: (y, z), (z, x) or (x, y).
int PlaneAxis(Axis axis, int index) { return (static_cast<int>(axis) + 1 + index) % 3; }

void FillBox(const BoundingBox& box, EvaluatedPart& part) {
  part.axis = Axis::kZ;
  part.outline.resize(2, 4);
  part.outline << box.minimum.x(), box.maximum.x(), box.maximum.x(), box.minimum.x(),
      box.minimum.y(), box.minimum.y(), box.maximum.y(), box.maximum.y();
  part.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
}

void FillRound(const BoundingBox& box, Axis about, EvaluatedPart& part) {
  const double turn = 2 * std::acos(-1.0) / kSides;
  // An outline of n corners on the circle is a little smaller than the circle.
  const double swell = std::sqrt(turn / std::sin(turn));
  part.axis = about;
  part.outline.resize(2, kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = (i + 0.5) * turn;
    const double corner[2] = {std::cos(angle), std::sin(angle)};
    for (int k = 0; k < 2; ++k) {
      const int axis = PlaneAxis(about, k);
      part.outline(k, i) = box.center()[axis] + 0.5 * swell * box.size()[axis] * corner[k];
    }
    part.face_names.push_back(absl::StrCat("side", i));
  }
  part.face_names.push_back("base");
  part.face_names.push_back("cap");
}

// Every vertex a linear function of the box and the places of held levels, and so of q.
void FillShape(const mesh::DrawnShape& shape, const PlacedPart& placed, EvaluatedPart& part) {
  FacetedShape& faceted = part.faceted.emplace();
  faceted.surface = SurfaceIn(shape, placed.box.center(), placed.stretch);
  faceted.triangle_face = shape.triangle_face;
  faceted.face_names = shape.face_names;
  std::vector<std::string> of_box;
  for (const std::vector<std::string>& names : shape.face_names) {
    part.face_names.push_back(names.front());
    for (std::size_t i = 1; i < names.size(); ++i) {
      if (std::find(of_box.begin(), of_box.end(), names[i]) == of_box.end()) {
        of_box.push_back(names[i]);
      }
    }
  }
  part.face_names.insert(part.face_names.end(), of_box.begin(), of_box.end());
}

}  // namespace

EvaluatedDesign DesignAt(const ParametricAssembly& assembly, const Eigen::VectorXd& q,
                         const std::vector<Item>& items, const std::vector<Material>& materials) {
  EvaluatedDesign design;
  design.template_name = assembly.assembly().name;
  design.structure = StructureAt(assembly, q);
  for (const PlacedPart& placed : assembly.PartsAt(q)) {
    const Element& element = assembly.elements()[static_cast<std::size_t>(placed.element)];
    const AssemblyPart& drawn =
        assembly.assembly().parts[static_cast<std::size_t>(element.parts.front())];
    const Item* const item = FindItem(items, element.item);
    EvaluatedPart part;
    part.name = placed.name;
    part.item = element.item;
    part.connecting = element.connecting;
    part.color = drawn.color;
    part.length_axis = drawn.item_axes[0];
    part.thickness_axis = drawn.item_axes[2];
    const std::optional<Axis> round = item == nullptr ? std::nullopt : RoundAbout(*item);
    if (element.shape != nullptr) {
      FillShape(*element.shape, placed, part);
    } else if (round) {
      FillRound(placed.box, drawn.item_axes[static_cast<std::size_t>(*round)], part);
    } else {
      FillBox(placed.box, part);
    }
    if (!part.faceted) {
      part.from = placed.box.minimum[static_cast<int>(part.axis)];
      part.to = placed.box.maximum[static_cast<int>(part.axis)];
    }
    part.minimum = placed.box.minimum;
    part.maximum = placed.box.maximum;
    for (int i = 0; i < 3; ++i) {
      part.size[i] =
          placed.box.size()[static_cast<int>(drawn.item_axes[static_cast<std::size_t>(i)])];
    }
    part.volume = part.faceted ? mesh::VolumeIn(*element.shape, placed.stretch)
                               : SignedArea(part.outline) * (part.to - part.from);
    if (item != nullptr) {
      const Material* const material = FindMaterial(materials, item->material);
      part.material = item->material;
      part.mass = material == nullptr ? 0 : material->density * part.volume;
      part.process = CuttingProcess(*item);
    }
    design.mass += part.mass;
    design.parts.push_back(std::move(part));
  }
  return design;
}

Structure StructureAt(const ParametricAssembly& assembly, const Eigen::VectorXd& q) {
  Structure structure;
  for (std::size_t e = 0; e < assembly.elements().size(); ++e) {
    const Element& element = assembly.elements()[e];
    if (!element.pattern) continue;
    const PatternLayout layout = LayOut(*element.pattern, BoxOf(q, static_cast<int>(e)));
    StructureCount& count = structure.counts.emplace_back();
    count.name = element.name;
    // The layout has 1 along a direction that there is not.
    for (std::size_t i = 0; i < 2; ++i) {
      if (element.pattern->directions[i].count < 2) continue;
      count.numbers.push_back(layout.directions[i].count);
    }
  }
  return structure;
}

}  // namespace mortise::parametric
