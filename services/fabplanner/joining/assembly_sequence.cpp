#include "services/fabplanner/joining/assembly_sequence.h"

#include <array>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "services/fabplanner/joining/assembly_order.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

// Which parts hang together (disjoint sets by part index).
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int Find(int part) {
    while (parent_[part] != part) part = parent_[part] = parent_[parent_[part]];
    return part;
  }
  void Join(int a, int b) { parent_[Find(a)] = Find(b); }

 private:
  std::vector<int> parent_;
};

// A connection between two parts with its priority, made of the pegs that name all three. Where a
// part is repeated, a connection of the design is one between each two copies.
struct PeggedConnection {
  int priority = 0;
  StepConnection connection;
};

absl::StatusOr<std::vector<PeggedConnection>> CollectConnections(
    const Design& design, const std::map<std::string, int>& part_index) {
  std::vector<PeggedConnection> connections;
  std::map<std::array<std::string, 3>, std::size_t> by_parts;
  std::map<std::string, int> priorities;  // by name
  for (const Peg& peg : design.pegs) {
    const std::string field = absl::StrCat("connection ", peg.connection);
    for (const std::string& part : {peg.part, peg.other_part}) {
      if (part_index.contains(part)) continue;
      return InvalidField(
          field, absl::StrCat("joins the part ", part, ", which the design does not have"));
    }
    if (peg.part == peg.other_part) return InvalidField(field, "joins a part to itself");
    if (priorities.emplace(peg.connection, peg.priority).first->second != peg.priority) {
      return InvalidField(field, "has pegs that differ in priority");
    }
    const auto [entry, is_new] =
        by_parts.emplace(std::array{peg.connection, peg.part, peg.other_part}, connections.size());
    if (is_new) {
      connections.push_back(
          {peg.priority, {peg.connection, peg.part, peg.other_part, peg.item, 0}});
    }
    ++connections[entry->second].connection.pegs;
  }
  return connections;
}

// Texts in their order, those that are alike once with how many there are: "2 × Side rail".
std::vector<std::string> Counted(const std::vector<std::string>& texts) {
  std::map<std::string, int> counts;
  for (const std::string& text : texts) ++counts[text];
  std::vector<std::string> counted;
  for (const std::string& text : texts) {
    int& count = counts[text];
    if (count == 0) continue;  // told already
    counted.push_back(count == 1 ? text : absl::StrCat(count, " × ", text));
    count = 0;
  }
  return counted;
}

std::string Titles(const Design& design, const std::map<std::string, int>& part_index,
                   const std::vector<std::string>& parts) {
  std::vector<std::string> titles;
  for (const std::string& name : parts) {
    const Part& part = design.parts[part_index.at(name)];
    titles.push_back(part.title.empty() ? part.name : part.title);
  }
  titles = Counted(titles);
  if (titles.size() < 2) return absl::StrJoin(titles, "");
  const std::string last = titles.back();
  titles.pop_back();
  return absl::StrCat(absl::StrJoin(titles, ", "), " and ", last);
}

// "4 pegs 8 × 35 mm", by item.
std::string PegsText(const AssemblyStep& step, const Items& items) {
  std::map<std::string, int> by_item;
  for (const StepConnection& connection : step.connections) {
    by_item[connection.item] += connection.pegs;
  }
  std::vector<std::string> texts;
  for (const auto& [name, count] : by_item) {
    std::string text = absl::StrCat(count, count == 1 ? " peg" : " pegs");
    if (const auto item = items.find(name); item != items.end()) {
      absl::StrAppend(&text, " ", Millimetres(item->second.size.y()), " × ",
                      Millimetres(item->second.size.x()), " mm");
    }
    texts.push_back(text);
  }
  return absl::StrJoin(texts, " and ");
}

// What hangs together by the step's connections, a text for each piece: the parts that the
// connections are of. `before`: which parts hung together before the step.
std::vector<std::string> PiecesOf(const Design& design,
                                  const std::map<std::string, int>& part_index,
                                  const AssemblyStep& step, Groups before) {
  for (const StepConnection& connection : step.connections) {
    before.Join(part_index.at(connection.part), part_index.at(connection.other_part));
  }
  std::vector<std::vector<std::string>> pieces;
  std::map<int, std::size_t> piece_of;  // by group
  std::set<std::string> told;
  for (const StepConnection& connection : step.connections) {
    for (const std::string& part : {connection.part, connection.other_part}) {
      if (!told.insert(part).second) continue;
      const auto [piece, is_new] =
          piece_of.emplace(before.Find(part_index.at(part)), pieces.size());
      if (is_new) pieces.emplace_back();
      pieces[piece->second].push_back(part);
    }
  }
  std::vector<std::string> texts;
  for (const std::vector<std::string>& piece : pieces) {
    texts.push_back(Titles(design, part_index, piece));
  }
  return texts;
}

// Alike pieces once, with how many there are: "2 × (Post and Rail)".
std::vector<std::string> Folded(const std::vector<std::string>& pieces) {
  std::map<std::string, int> counts;
  std::vector<std::string> order;
  for (const std::string& piece : pieces) {
    if (++counts[piece] == 1) order.push_back(piece);
  }
  for (std::string& piece : order) {
    if (counts[piece] > 1) piece = absl::StrCat(counts[piece], " × (", piece, ")");
  }
  return order;
}

// `before`: which parts hung together before the step.
std::string Instruction(const Design& design, const Items& items,
                        const std::map<std::string, int>& part_index, const AssemblyStep& step,
                        Groups& before, const std::set<std::string>& present) {
  const auto titles = [&](const std::vector<std::string>& parts) {
    return Titles(design, part_index, parts);
  };
  std::string text;
  if (!step.added_parts.empty()) {
    absl::StrAppend(&text, "Take ", titles(step.added_parts), ". ");
  }
  if (step.connections.empty()) return absl::StrCat(text, "Nothing needs joining.");
  absl::StrAppend(&text, "Put ", PegsText(step, items), " into the holes: ");
  std::vector<std::string> joints;
  std::set<int> standing;  // groups of what stands already that this step touches
  for (const StepConnection& connection : step.connections) {
    joints.push_back(absl::StrCat(connection.pegs, " between ",
                                  titles({connection.part, connection.other_part})));
    for (const std::string& part : {connection.part, connection.other_part}) {
      if (present.contains(part)) standing.insert(before.Find(part_index.at(part)));
    }
  }
  absl::StrAppend(&text, absl::StrJoin(Counted(joints), ", "), ". ");
  const std::vector<std::string> pieces = PiecesOf(design, part_index, step, before);
  if (pieces.size() > 1) {
    return absl::StrCat(text, "This makes ", pieces.size(),
                        " separate pieces. Push together, each by itself: ",
                        absl::StrJoin(Folded(pieces), "; "), ".");
  }
  if (standing.empty()) return absl::StrCat(text, "Push the parts together.");
  if (standing.size() > 1) {
    return absl::StrCat(text, "This joins ", standing.size(),
                        " sub-assemblies built before: push everything together.");
  }
  return absl::StrCat(text, step.added_parts.size() == 1 ? "Push it onto" : "Push them onto",
                      " what is built already.");
}

absl::Status CheckConnected(const Design& design, Groups& groups) {
  if (design.parts.empty()) return absl::OkStatus();
  std::vector<std::string> loose;
  for (std::size_t i = 1; i < design.parts.size(); ++i) {
    if (groups.Find(static_cast<int>(i)) != groups.Find(0)) loose.push_back(design.parts[i].name);
  }
  if (loose.empty()) return absl::OkStatus();
  return PreconditionFailed(
      "PARTS_UNCONNECTED",
      absl::StrCat("no connections hold ", absl::StrJoin(loose, ", "), " and ",
                   design.parts.front().name, " together: add connections to the template"),
      loose.front());
}

absl::StatusOr<std::vector<AssemblyStep>> StepsByShape(const Design& design, const Items& items,
                                                       const std::vector<Mark>& marks,
                                                       const std::stop_token& stop) {
  if (design.parts.size() > kMaxOrderedParts) {
    return TooLarge(
        absl::StrCat("the order in which ", design.parts.size(), " parts are put together"),
        absl::StrCat(kMaxOrderedParts, " parts in one design"));
  }
  auto steps = OrderedSteps(design, items, marks, stop);
  if (stop.stop_requested()) return absl::CancelledError("the ordering of the steps was stopped");
  return steps;
}

}  // namespace

absl::StatusOr<std::vector<AssemblyStep>> AssemblySteps(const Design& design, const Items& items,
                                                        const std::vector<Mark>& marks,
                                                        const std::stop_token& stop) {
  std::map<std::string, int> part_index;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    if (!part_index.emplace(design.parts[i].name, static_cast<int>(i)).second) {
      return InvalidField(absl::StrCat("parts[", i, "].name"),
                          absl::StrCat("is used twice: ", design.parts[i].name));
    }
  }
  if (HasOrderOfItsOwn(design)) return StepsByShape(design, items, marks, stop);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<PeggedConnection> connections,
                           CollectConnections(design, part_index));
  std::map<int, AssemblyStep> by_priority;
  for (const PeggedConnection& pegged : connections) {
    AssemblyStep& step = by_priority[pegged.priority];
    step.priority = pegged.priority;
    step.connections.push_back(pegged.connection);
    step.pegs += pegged.connection.pegs;
  }
  if (by_priority.empty() && design.parts.size() == 1) {
    by_priority[0].added_parts = {design.parts.front().name};
  }

  std::vector<AssemblyStep> steps;
  std::set<std::string> present;
  Groups groups(design.parts.size());
  for (auto& [priority, step] : by_priority) {
    step.number = static_cast<int>(steps.size()) + 1;
    std::set<std::string> joined;
    for (const StepConnection& connection : step.connections) {
      joined.insert({connection.part, connection.other_part});
    }
    for (const Part& part : design.parts) {  // in the design's order
      if (joined.contains(part.name) && !present.contains(part.name)) {
        step.added_parts.push_back(part.name);
      }
    }
    step.instruction = Instruction(design, items, part_index, step, groups, present);
    for (const StepConnection& connection : step.connections) {
      groups.Join(part_index.at(connection.part), part_index.at(connection.other_part));
    }
    present.insert(joined.begin(), joined.end());
    steps.push_back(std::move(step));
  }
  MORTISE_RETURN_IF_ERROR(CheckConnected(design, groups));
  return steps;
}

}  // namespace mortise::fabplanner
