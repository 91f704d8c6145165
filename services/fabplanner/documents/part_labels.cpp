#include "services/fabplanner/documents/part_labels.h"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting/stock_cutting.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kLongestAddress = 500;  // bytes

std::string PercentEncoded(const std::string& text) {
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte) || absl::StrContains("-._~", std::string(1, c))) {
      encoded += c;
    } else {
      absl::StrAppendFormat(&encoded, "%%%02X", byte);
    }
  }
  return encoded;
}

class LabelWriter {
 public:
  LabelWriter(const FabricationPlan& plan, const Design& design, const Items& items,
              const PlanNames& names)
      : plan_(plan), design_(design), items_(items), names_(names) {
    for (std::size_t i = 0; i < design.parts.size(); ++i) {
      for (int copy = 1; copy <= plan.quantity; ++copy) {
        parts_[PartLabel(design.parts[i].name, copy, plan.quantity)] = i;
      }
    }
    for (const AssemblyStep& step : plan.steps) {
      for (const std::string& part : step.added_parts) steps_.emplace(part, step.number);
      for (const std::string& part : step.connectors) steps_.emplace(part, step.number);
    }
  }

  std::vector<LabelContents> Write() {
    for (const BoardLayout& board : plan_.boards) {
      for (const BoardSegment& segment : board.segments) {
        Add(segment.part, absl::StrCat(board.label, " at ", Millimetres(segment.start), " mm"));
      }
    }
    for (const SheetLayout& sheet : plan_.sheets) {
      for (const SheetPlacement& placement : sheet.placements) {
        Eigen::Vector2d lower = placement.outline.front();
        for (const Eigen::Vector2d& point : placement.outline) lower = lower.cwiseMin(point);
        Add(placement.part, absl::StrCat(sheet.label, " at ", Millimetres(lower.x()), ", ",
                                         Millimetres(lower.y()), " mm"));
      }
    }
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      const Making making = plan_.parts[i].making;
      if (making == Making::kBought && design_.parts[i].connecting) continue;
      for (int copy = 1; copy <= plan_.quantity; ++copy) {
        Add(PartLabel(design_.parts[i].name, copy, plan_.quantity),
            making == Making::kToDrawing ? "made to drawing" : "bought");
      }
    }
    return std::move(labels_);
  }

 private:
  // Once for each part.
  void Add(const std::string& label, std::string stock) {
    const auto found = parts_.find(label);
    if (found == parts_.end() || !written_.insert(label).second) return;
    const Part& part = design_.parts[found->second];
    const auto step = steps_.find(part.name);
    const auto item = items_.find(part.item);
    LabelContents& contents = labels_.emplace_back();
    contents.part = label;
    contents.step = step == steps_.end() ? 0 : step->second;
    contents.size = SizeText(plan_.parts[found->second].size);
    contents.stock = std::move(stock);
    contents.item = item == items_.end()         ? part.material
                    : item->second.title.empty() ? item->second.name
                                                 : item->second.title;
    contents.code = CodeText(names_, label, contents.step);
  }

  const FabricationPlan& plan_;
  const Design& design_;
  const Items& items_;
  const PlanNames& names_;
  std::unordered_map<std::string, std::size_t> parts_;  // by label
  std::unordered_map<std::string, int> steps_;          // by name
  std::set<std::string> written_;
  std::vector<LabelContents> labels_;
};

}  // namespace

std::vector<LabelContents> LabelsOf(const FabricationPlan& plan, const Design& design,
                                    const Items& items, const PlanNames& names) {
  return LabelWriter(plan, design, items, names).Write();
}

std::string CodeText(const PlanNames& names, const std::string& part, int step) {
  std::string text = names.address;
  if (!text.empty() && text.back() != '/') text += '/';
  absl::StrAppend(&text, names.plan, names.plan.empty() ? "" : "/", "parts/", PercentEncoded(part));
  if (step > 0) absl::StrAppend(&text, "?step=", step);
  return text;
}

absl::Status CheckLabelAddress(const std::string& address, const std::string& field) {
  if (address.empty()) return absl::OkStatus();
  if (address.size() > kLongestAddress) {
    return InvalidField(
        field, absl::StrCat("has ", address.size(), " bytes, more than ", kLongestAddress));
  }
  const std::size_t host = absl::StartsWith(address, "https://")  ? 8
                           : absl::StartsWith(address, "http://") ? 7
                                                                  : 0;
  if (host == 0) return InvalidField(field, "must begin with https:// or http://");
  if (host == address.size() || address[host] == '/' || address[host] == ':') {
    return InvalidField(field, "names no host");
  }
  for (const char c : address) {
    if (!absl::ascii_isgraph(static_cast<unsigned char>(c)) ||
        absl::StrContains("\"<>\\^`{|}", std::string(1, c))) {
      return InvalidField(field, "has a character that addresses write as %20 and the like");
    }
    if (c == '?' || c == '#' || c == '@') {
      return InvalidField(field, absl::StrCat("must end before any \"", std::string(1, c),
                                              "\": plan and part are put behind it"));
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::fabplanner
