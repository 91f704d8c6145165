#include "services/fabplanner/service/design_codec.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/template_codec.h"

namespace mortise::fabplanner {
namespace {

CutProcess ProcessFrom(parametric::Process process) {
  switch (process) {
    case parametric::Process::kChopSaw:
      return CutProcess::kChopSaw;
    case parametric::Process::kJigsaw:
      return CutProcess::kJigsaw;
    default:
      return CutProcess::kNone;
  }
}

ItemKind KindFrom(const parametric::Item& item) {
  switch (item.kind) {
    case parametric::ItemKind::kBoard:
    case parametric::ItemKind::kProfile:
    case parametric::ItemKind::kTube:
      return ItemKind::kBoard;
    case parametric::ItemKind::kSheet:
      return ItemKind::kSheet;
    case parametric::ItemKind::kDowel:
      return ItemKind::kDowel;
    case parametric::ItemKind::kScrew: {
      // Screws with a metric thread say its pitch.
      const bool metric = std::any_of(
          item.measures.begin(), item.measures.end(),
          [](const parametric::ItemMeasure& measure) { return measure.name == "thread_pitch"; });
      return metric ? ItemKind::kBolt : ItemKind::kScrew;
    }
    case parametric::ItemKind::kBolt:
    case parametric::ItemKind::kThreadedRod:
      return ItemKind::kBolt;
    case parametric::ItemKind::kNut:
    case parametric::ItemKind::kWasher:
      return ItemKind::kNut;
    default:
      return ItemKind::kHardware;
  }
}

bool IsRound(parametric::ItemKind kind) {
  switch (kind) {
    case parametric::ItemKind::kDowel:
    case parametric::ItemKind::kScrew:
    case parametric::ItemKind::kBolt:
    case parametric::ItemKind::kThreadedRod:
    case parametric::ItemKind::kTube:
    case parametric::ItemKind::kNut:
    case parametric::ItemKind::kWasher:
    case parametric::ItemKind::kBearing:
    case parametric::ItemKind::kWheel:
      return true;
    default:
      return false;
  }
}

// Round hardware that is longer than thick, such as shelf pins, cam bolts and insert nuts. What is
// cut to length, such as a chain, is none.
bool IsPin(const parametric::Item& item) {
  const double diameter = item.dimensions[1].size;
  return item.kind == parametric::ItemKind::kHardware &&
         item.dimensions[0].process == parametric::Process::kNone &&
         std::abs(diameter - item.dimensions[2].size) < 1e-6 && item.dimensions[0].size > diameter;
}

Item ItemFrom(const parametric::Item& read) {
  Item item;
  item.name = read.name;
  item.title = read.title;
  item.kind = KindFrom(read);
  item.round = IsRound(read.kind);
  item.shaped = !read.shape.empty();
  item.pin = IsPin(read);
  for (int axis = 0; axis < 3; ++axis) {
    const parametric::ItemDimension& dimension = read.dimensions[axis];
    item.size[axis] = dimension.size;
    const bool fixed = dimension.process == parametric::Process::kNone;
    item.limits[axis] = {fixed ? dimension.size : dimension.minimum,
                         fixed ? dimension.size : dimension.maximum};
    item.ripped = item.ripped || dimension.process == parametric::Process::kRipSaw;
  }
  item.price = read.price;
  item.price_per_volume = read.price_basis == parametric::PriceBasis::kPerVolume;
  item.supplier = read.supplier;
  item.supplier_number = read.supplier_number;
  item.supplier_url = read.supplier_url;
  item.stock = read.stock_sizes;
  item.revision = read.revision;
  item.material = read.material;
  for (const parametric::ItemMeasure& measure : read.measures) {
    item.measures[measure.name] = measure.size;
  }
  return item;
}

Part PartFrom(const parametric::EvaluatedPart& evaluated) {
  Part part;
  part.name = evaluated.name;
  part.title = evaluated.title;
  part.item = evaluated.item;
  part.process = ProcessFrom(evaluated.process);
  part.size = evaluated.size;
  part.length_axis = static_cast<int>(evaluated.length_axis);
  part.thickness_axis = static_cast<int>(evaluated.thickness_axis);
  part.extrusion_axis = static_cast<int>(evaluated.axis);
  part.material = evaluated.material;
  part.mass = evaluated.mass;
  part.connecting = evaluated.connecting;
  if (evaluated.faceted) {
    part.vertices = evaluated.faceted->surface.vertices;
    part.triangles = evaluated.faceted->surface.triangles;
    return part;
  }
  for (Eigen::Index i = 0; i < evaluated.outline.cols(); ++i) {
    part.outline.push_back(evaluated.outline.col(i));
  }
  part.from = evaluated.from;
  part.to = evaluated.to;
  return part;
}

// Whether `name` is that of a part as drawn, or of one of its repetitions: "slat 3", "leg 1.2", or
// "slat 1 12" of a row that has more than were drawn.
bool IsRepetitionOf(const std::string& name, const std::string& drawn) {
  if (!absl::StartsWith(name, drawn)) return false;
  const std::string rest = name.substr(drawn.size());
  if (rest.empty()) return true;
  return rest.front() == ' ' && std::all_of(rest.begin(), rest.end(), [](char c) {
           return absl::ascii_isdigit(static_cast<unsigned char>(c)) || c == '.' || c == ' ';
         });
}

}  // namespace

absl::StatusOr<Design> DesignFrom(const v1::EvaluatedDesign& evaluated_message) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign evaluated,
                           parametric::FromProto(evaluated_message));
  Design design;
  for (const parametric::EvaluatedPart& part : evaluated.parts) {
    design.parts.push_back(PartFrom(part));
  }
  for (const parametric::EvaluatedConnector& connector : evaluated.connectors) {
    design.pegs.push_back({connector.connection, connector.item, connector.part,
                           connector.other_part, connector.position, connector.direction,
                           connector.diameter, connector.length, connector.depth_in_part,
                           connector.priority});
  }
  return design;
}

void AddDrawing(const v1::Assembly& assembly, Design* design) {
  design->is_drawn = !assembly.parts().empty();
  // Parents before their children, as Design wants them.
  std::map<std::string, int> group_index = {{"", 0}};
  bool found = true;
  while (found) {
    found = false;
    for (const v1::AssemblyGroup& group : assembly.groups()) {
      const auto parent = group_index.find(group.parent());
      if (parent == group_index.end() || group_index.contains(group.name())) continue;
      group_index[group.name()] = static_cast<int>(design->groups.size());
      design->groups.push_back({group.name(), parent->second});
      found = true;
    }
  }
  for (Part& part : design->parts) {
    const v1::AssemblyPart* drawn = nullptr;
    for (const v1::AssemblyPart& candidate : assembly.parts()) {
      if (IsRepetitionOf(part.name, candidate.name()) &&
          (drawn == nullptr || candidate.name().size() > drawn->name().size())) {
        drawn = &candidate;
      }
    }
    if (drawn == nullptr) continue;
    if (part.title.empty()) part.title = drawn->title();
    part.family = drawn->name();
    part.priority = drawn->priority();
    const auto group = group_index.find(drawn->group());
    if (group != group_index.end()) part.group = group->second;
  }
}

absl::StatusOr<Items> ItemsFrom(const v1::TemplateBundle& bundle) {
  std::map<std::string, bool> has_grain;  // of materials
  for (const v1::Material& material : bundle.materials()) {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Material read, parametric::FromProto(material));
    has_grain[read.name] = read.HasGrain();
  }
  Items items;
  for (int i = 0; i < bundle.items_size(); ++i) {
    const absl::StatusOr<parametric::Item> read = parametric::FromProto(bundle.items(i));
    if (!read.ok()) return UnderField(absl::StrCat("items[", i, "]"), read.status());
    Item item = ItemFrom(*read);
    const auto& external_ids = bundle.items(i).external_ids();
    item.external_ids.assign(external_ids.begin(), external_ids.end());
    if (const auto grain = has_grain.find(read->material); grain != has_grain.end()) {
      item.has_grain = grain->second;
    }
    items.emplace(read->name, std::move(item));
  }
  return items;
}

}  // namespace mortise::fabplanner
