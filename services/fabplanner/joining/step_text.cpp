#include "services/fabplanner/joining/step_text.h"

#include <algorithm>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

std::string Enumerated(std::vector<std::string> texts) {
  if (texts.size() < 2) return absl::StrJoin(texts, "");
  const std::string last = texts.back();
  texts.pop_back();
  return absl::StrCat(absl::StrJoin(texts, ", "), " and ", last);
}

// Texts with how often each occurs, in order of appearance.
std::vector<std::string> Counted(const std::vector<std::string>& texts) {
  std::map<std::string, int> counts;
  std::vector<std::string> order;
  for (const std::string& text : texts) {
    if (++counts[text] == 1) order.push_back(text);
  }
  for (std::string& text : order) {
    if (counts[text] > 1) text = absl::StrCat(counts[text], " × ", text);
  }
  return order;
}

std::string NameOf(const Design& design, const StepFacts::Arrival& arrival) {
  if (absl::StartsWith(arrival.built, "piece ")) return arrival.built;
  if (!arrival.built.empty()) return absl::StrCat("the ", arrival.built);
  return TitleOf(design.parts[arrival.parts.front()]);
}

// "Begin with …" or "Put … in place from above", by where they come from.
void AppendArrivals(const Design& design, const StepFacts& facts, std::string* text) {
  std::map<std::string, std::vector<std::string>> by_way;
  std::vector<std::string> ways;
  for (const StepFacts::Arrival& arrival : facts.arrivals) {
    std::vector<std::string>& names = by_way[arrival.coming_from];
    if (names.empty()) ways.push_back(arrival.coming_from);
    names.push_back(NameOf(design, arrival));
  }
  for (const std::string& way : ways) {
    const std::string names = Enumerated(Counted(by_way[way]));
    if (way.empty()) {
      absl::StrAppend(text, facts.stuck.empty() ? "Begin with " : "Take ", names, ". ");
    } else {
      absl::StrAppend(text, "Put ", names, " in place ", way, ". ");
    }
  }
}

void AppendConnectors(const Design& design, const Items& items, const StepFacts& facts,
                      std::string* text) {
  std::vector<std::string> pegs, rest;
  for (int connector : facts.connectors) {
    const auto item = items.find(design.parts[connector].item);
    const bool known = item != items.end();
    std::string title = known && !item->second.title.empty() ? item->second.title
                                                             : TitleOf(design.parts[connector]);
    if (design.parts[connector].process == CutProcess::kChopSaw) {
      absl::StrAppend(&title, ", cut to ", Millimetres(design.parts[connector].size.x()), " mm");
    }
    const bool peg = known && item->second.kind == ItemKind::kDowel;
    (peg ? pegs : rest).push_back(std::move(title));
  }
  if (!pegs.empty()) {
    absl::StrAppend(text, "Put ", absl::StrJoin(Counted(pegs), "; "), " into the holes first. ");
  }
  if (!rest.empty()) {
    absl::StrAppend(text, "Fasten with ", absl::StrJoin(Counted(rest), "; "), ". ");
  }
}

std::vector<std::string> Names(const Design& design, const std::vector<int>& parts) {
  std::vector<std::string> names;
  for (int part : parts) names.push_back(design.parts[part].name);
  return names;
}

}  // namespace

std::string CountedTitles(const Design& design, const std::vector<int>& parts) {
  std::vector<std::string> titles;
  for (int part : parts) titles.push_back(TitleOf(design.parts[part]));
  return Enumerated(Counted(titles));
}

std::string MarkText(const Design& design, const Mark& mark) {
  constexpr const char* kFrom[] = {"from the left", "from the front", "from below"};
  std::vector<std::string> texts;
  for (const Part& part : design.parts) {
    if (part.name != mark.part) continue;
    const Eigen::AlignedBox3d box = BoundsOf(part);
    int normal = 0;  // of the face that it lies on: the mark has no thickness there
    mark.region.sizes().minCoeff(&normal);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == normal) continue;
      texts.push_back(
          absl::StrCat(Millimetres(std::max(0.0, mark.region.min()[axis] - box.min()[axis])),
                       " mm ", kFrom[axis]));
    }
  }
  return Enumerated(std::move(texts));
}

std::string StepText(const Design& design, const Items& items, const StepFacts& facts) {
  std::string text;
  AppendArrivals(design, facts, &text);
  AppendConnectors(design, items, facts, &text);
  for (const Mark& mark : facts.marks) {
    absl::StrAppend(&text, "Mark ", mark.connector, " on ", mark.part, ": its corner is ",
                    MarkText(design, mark), ". ");
  }
  for (const auto& [a, b] : facts.unknown) {
    absl::StrAppend(&text, design.parts[a].name, " and ", design.parts[b].name,
                    " reach into each other; how they are joined is not known. ");
  }
  if (!facts.stuck.empty()) {
    absl::StrAppend(&text,
                    "No straight movement along an axis brings these together, for each "
                    "stands in another's way: ",
                    Enumerated(Names(design, facts.stuck)), ". ");
  }
  return std::string(absl::StripAsciiWhitespace(text));
}

}  // namespace mortise::fabplanner
