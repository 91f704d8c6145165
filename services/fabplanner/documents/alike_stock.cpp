#include "services/fabplanner/documents/alike_stock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kMaxLabels = 12;

int64_t Micrometres(double metres) { return std::llround(metres * 1e6); }

// Groups by what a cut looks like; `key` makes an ordered description of layout i.
template <class Layout, class Key>
std::vector<AlikeStock> GroupAlike(const std::vector<Layout>& layouts, Key key) {
  std::vector<AlikeStock> groups;
  std::map<decltype(key(layouts.front())), std::size_t> known;
  for (std::size_t i = 0; i < layouts.size(); ++i) {
    const auto [entry, is_new] = known.emplace(key(layouts[i]), groups.size());
    if (is_new) groups.push_back({i, {}});
    groups[entry->second].labels.push_back(layouts[i].label);
  }
  return groups;
}

auto BoardKey(const BoardLayout& board) {
  std::vector<std::tuple<std::string, int64_t, std::array<int64_t, 4>>> parts;
  for (const BoardSegment& segment : board.segments) {
    const CutEnds& ends = segment.ends;
    parts.emplace_back(WithoutCopy(segment.part), Micrometres(segment.length),
                       std::array<int64_t, 4>{Micrometres(ends.front.across * board.width),
                                              Micrometres(ends.front.through * board.thickness),
                                              Micrometres(ends.rear.across * board.width),
                                              Micrometres(ends.rear.through * board.thickness)});
  }
  return std::make_tuple(board.item, Micrometres(board.width), Micrometres(board.thickness),
                         Micrometres(board.stock_length), parts);
}

auto SheetKey(const SheetLayout& sheet) {
  std::vector<std::pair<std::string, std::vector<int64_t>>> parts;
  for (const SheetPlacement& placement : sheet.placements) {
    std::vector<int64_t> points;
    for (const Eigen::Vector2d& point : placement.outline) {
      points.push_back(Micrometres(point.x()));
      points.push_back(Micrometres(point.y()));
    }
    parts.emplace_back(WithoutCopy(placement.part), points);
  }
  return std::make_tuple(sheet.item, Micrometres(sheet.length), Micrometres(sheet.width),
                         Micrometres(sheet.thickness), parts);
}

}  // namespace

std::string LabelsText(const AlikeStock& alike) {
  std::string text = alike.labels.front();
  if (alike.labels.size() == 1) return text;
  for (std::size_t i = 1; i < std::min(alike.labels.size(), kMaxLabels); ++i) {
    const std::string& label = alike.labels[i];
    absl::StrAppend(&text, ", ", label.substr(label.rfind('-') + 1));
  }
  if (alike.labels.size() > kMaxLabels) absl::StrAppend(&text, " …");
  return absl::StrCat(text, " (", alike.labels.size(), " alike)");
}

std::string WithoutCopy(const std::string& label) { return label.substr(0, label.find('.')); }

std::vector<AlikeStock> AlikeBoards(const std::vector<BoardLayout>& boards) {
  return GroupAlike(boards, BoardKey);
}

std::vector<AlikeStock> AlikeSheets(const std::vector<SheetLayout>& sheets) {
  return GroupAlike(sheets, SheetKey);
}

}  // namespace mortise::fabplanner
