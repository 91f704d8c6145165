#include "services/fabplanner/planning/bill_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/joining/joinery.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/money.h"
#include "services/fabplanner/planning/stock_shares.h"

namespace mortise::fabplanner {
namespace {

using Contour = std::vector<std::pair<int64_t, int64_t>>;  // µm

// The outline of a part as it is cut, from its first corner, so that alike ones are equal.
Contour ContourOf(const Part& part) {
  Contour outline;
  for (const Eigen::Vector2d& point : SheetOutlineOf(part)) {
    outline.emplace_back(std::llround(point.x() * 1e6), std::llround(point.y() * 1e6));
  }
  std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
  return outline;
}

// What parts of one node have in common.
using Likeness = std::tuple<std::string, std::string, Making, Ware, std::array<int64_t, 4>, Contour,
                            std::vector<std::string>>;

Likeness LikenessOf(const Part& part, const PlannedPart& planned) {
  const auto slope = [](double value) -> int64_t { return std::llround(value * 1e6); };
  const CutEnds& ends = planned.ends;
  return {part.title,
          part.material,
          planned.making,
          WareOf(part.item, planned.size),
          {slope(ends.front.across), slope(ends.front.through), slope(ends.rear.across),
           slope(ends.rear.through)},
          planned.making == Making::kOutline ? ContourOf(part) : Contour{},
          planned.drawings};
}

// Pictures of the steps in which each part comes in.
std::map<std::string, std::vector<std::string>> PicturesOf(const FabricationPlan& plan) {
  std::map<std::string, std::vector<std::string>> pictures;
  for (const AssemblyStep& step : plan.steps) {
    const std::string picture = StepPictureName(step.number);
    for (const std::string& part : step.added_parts) pictures[part].push_back(picture);
    for (const std::string& part : step.connectors) pictures[part].push_back(picture);
  }
  return pictures;
}

void AddNew(const std::string& text, std::vector<std::string>* list) {
  if (std::find(list->begin(), list->end(), text) == list->end()) list->push_back(text);
}

// Makes the tree from the whole downwards, then gives it its prices.
class TreeMaker {
 public:
  TreeMaker(const FabricationPlan& plan, const Design& design, const Items& items)
      : plan_(plan),
        design_(design),
        items_(items),
        shares_(StockShares(plan, design, items)),
        pictures_(PicturesOf(plan)) {
    for (std::size_t i = 0; i < plan.bill.lines.size(); ++i) {
      const BillLine& line = plan.bill.lines[i];
      if (!line.item.empty()) line_of_ware_[WareOf(line.item, line.size)] = i;
      for (const std::string& part : line.parts) line_of_part_[part] = i;
    }
    for (const Hole& hole : plan.holes) drilled_.insert(hole.part);
    FindGroupParts();
  }

  BillTree Make(const BillSubject& subject) {
    tree_.template_name = subject.template_name;
    tree_.template_revision = subject.template_revision;
    tree_.assembly = subject.assembly;
    tree_.assembly_revision = subject.assembly_revision;
    tree_.effective_from = subject.effective_from;
    AddGroup(0, -1);
    BillNode& whole = tree_.nodes.front();
    whole.name = subject.template_name;
    whole.title = subject.title;
    whole.external_ids = subject.external_ids;
    PriceLeaves();
    PriceWhatHoldsThem();
    return std::move(tree_);
  }

 private:
  // Parts of each group, and of each with all groups below it.
  void FindGroupParts() {
    parts_in_.resize(design_.groups.size());
    parts_below_.resize(design_.groups.size());
    for (std::size_t i = 0; i < design_.parts.size(); ++i) {
      int group = design_.parts[i].group;
      parts_in_[static_cast<std::size_t>(group)].push_back(i);
      for (; group >= 0; group = design_.groups[static_cast<std::size_t>(group)].parent) {
        parts_below_[static_cast<std::size_t>(group)].push_back(i);
      }
    }
  }

  // Adds a node that is there `quantity` times in one of its parent.
  int AddNode(int parent, BillNodeKind kind, double quantity) {
    const int index = static_cast<int>(tree_.nodes.size());
    BillNode& node = tree_.nodes.emplace_back();
    children_.push_back(0);
    node.parent = parent;
    node.kind = kind;
    node.quantity = quantity;
    if (parent < 0) {
      node.id = "1";
      node.total_quantity = plan_.quantity;
      return index;
    }
    const BillNode& above = tree_.nodes[static_cast<std::size_t>(parent)];
    node.id = absl::StrCat(above.id, ".", ++children_[static_cast<std::size_t>(parent)]);
    node.total_quantity = quantity * above.total_quantity;
    return index;
  }

  BillNode& At(int node) { return tree_.nodes[static_cast<std::size_t>(node)]; }

  void AddGroup(int group, int parent) {
    const int node =
        AddNode(parent, parent < 0 ? BillNodeKind::kAssembly : BillNodeKind::kSubAssembly, 1);
    DescribeGroup(group, &At(node));
    for (int child = group + 1; child < static_cast<int>(design_.groups.size()); ++child) {
      if (design_.groups[static_cast<std::size_t>(child)].parent != group) continue;
      if (!parts_below_[static_cast<std::size_t>(child)].empty()) AddGroup(child, node);
    }
    std::map<Likeness, std::size_t> known;
    std::vector<std::vector<std::size_t>> alike;
    for (const std::size_t part : parts_in_[static_cast<std::size_t>(group)]) {
      const auto [entry, is_new] =
          known.emplace(LikenessOf(design_.parts[part], plan_.parts[part]), alike.size());
      if (is_new) alike.emplace_back();
      alike[entry->second].push_back(part);
    }
    for (const std::vector<std::size_t>& parts : alike) AddParts(parts, node);
    if (parent < 0) AddPegs(node);
  }

  void DescribeGroup(int group, BillNode* node) {
    const std::string& name = design_.groups[static_cast<std::size_t>(group)].name;
    node->name = name;
    node->title = name;
    Eigen::AlignedBox3d box;
    double mass = 0;
    bool is_known = true;
    for (const std::size_t part : parts_below_[static_cast<std::size_t>(group)]) {
      box.extend(BoundsOf(design_.parts[part]));
      mass += design_.parts[part].mass;
      is_known = is_known && design_.parts[part].mass > 0;
      for (const std::string& drawing : plan_.parts[part].drawings) {
        // One of the whole, besides those of its parts.
        if (group == 0 && drawing == kDesignStepFile) AddNew(drawing, &node->artifacts);
      }
    }
    if (is_known) node->mass = mass;
    node->size = box.sizes();
    node->dimensions = SizeText(node->size);
    if (group == 0) {
      for (const char* file : {"assembly-guide.html", "assembly-guide.pdf", "parts.csv"}) {
        node->artifacts.push_back(file);
      }
      return;
    }
    for (const AssemblyStep& step : plan_.steps) {
      if (step.subassembly == name) AddNew(StepPictureName(step.number), &node->artifacts);
    }
  }

  // One node of parts that are alike, with what they are cut from.
  void AddParts(const std::vector<std::size_t>& parts, int parent) {
    const Part& first = design_.parts[parts.front()];
    const PlannedPart& planned = plan_.parts[parts.front()];
    const bool is_bought = planned.making == Making::kBought;
    const int index =
        AddNode(parent, is_bought ? BillNodeKind::kBought : BillNodeKind::kPart, parts.size());
    BillNode& node = At(index);
    node.name = first.name;
    node.title = TitleOf(first);
    node.item = first.item;
    node.material = first.material;
    if (first.mass > 0) node.mass = first.mass;
    node.size = planned.size;
    node.dimensions = SizeText(planned.size);
    node.artifacts = planned.drawings;
    for (const std::size_t part : parts) node.parts.push_back(design_.parts[part].name);
    AddPartFiles(planned.making, &node);
    if (const auto item = items_.find(first.item); item != items_.end()) {
      node.item_revision = item->second.revision;
    }
    if (is_bought) {
      AddLeaf(index, line_of_ware_.at(WareOf(first.item, first.size)));
      node.title = TitleOf(first);
    } else if (planned.making == Making::kToDrawing) {
      leaves_[line_of_part_.at(first.name)].push_back(index);
    } else {
      AddStock(parts, index);
    }
  }

  // Lists, diagrams and pictures that have the node's parts.
  void AddPartFiles(Making making, BillNode* node) const {
    const bool is_cut = making == Making::kCrosscut || making == Making::kOutline;
    if (is_cut) {
      for (const char* file : {"cut-list.csv", "cut-list.pdf"}) node->artifacts.push_back(file);
      node->artifacts.push_back(making == Making::kOutline ? "sheets.svg" : "boards.svg");
    }
    const bool is_drilled = std::any_of(node->parts.begin(), node->parts.end(),
                                        [&](const auto& part) { return drilled_.contains(part); });
    if (is_drilled) node->artifacts.push_back("holes.csv");
    for (const std::string& part : node->parts) {
      const auto pictures = pictures_.find(part);
      if (pictures == pictures_.end()) continue;
      for (const std::string& picture : pictures->second) AddNew(picture, &node->artifacts);
    }
  }

  void AddStock(const std::vector<std::size_t>& parts, int parent) {
    std::map<Ware, double> taken;
    for (const std::size_t part : parts) {
      for (const auto& [ware, pieces] : shares_[part]) taken[ware] += pieces;
    }
    for (const auto& [ware, pieces] : taken) {
      const int node = AddNode(parent, BillNodeKind::kStock, pieces / At(parent).total_quantity);
      At(node).total_quantity = pieces;
      AddLeaf(node, line_of_ware_.at(ware));
      for (const std::string& file : At(parent).artifacts) {
        const bool shows_stock =
            file.starts_with("cut-list.") || file == "boards.svg" || file == "sheets.svg";
        if (shows_stock) At(node).artifacts.push_back(file);
      }
    }
  }

  void AddPegs(int parent) {
    for (const auto& [item, count] : CountPegs(design_)) {
      const int node = AddNode(parent, BillNodeKind::kBought, count);
      AddLeaf(node, line_of_ware_.at(WareOf(item, items_.at(item).size)));
      At(node).artifacts.push_back("holes.csv");
      for (const AssemblyStep& step : plan_.steps) {
        const bool has_some =
            std::any_of(step.connections.begin(), step.connections.end(),
                        [&](const StepConnection& made) { return made.item == item; });
        if (has_some) AddNew(StepPictureName(step.number), &At(node).artifacts);
      }
    }
  }

  // Tells of a node that it is of a line of the bill, as that has it.
  void AddLeaf(int index, std::size_t line_number) {
    const BillLine& line = plan_.bill.lines[line_number];
    const Item& item = items_.at(line.item);
    BillNode& node = At(index);
    leaves_[line_number].push_back(index);
    if (node.name.empty()) node.name = item.name;
    node.title = line.title;
    node.item = line.item;
    node.item_revision = item.revision;
    node.external_ids = item.external_ids;
    node.material = item.material;
    node.size = line.size;
    node.dimensions = line.dimensions;
    node.supplier = line.supplier;
    node.supplier_number = line.supplier_number;
    node.supplier_url = line.supplier_url;
  }

  // Shares the price of each line between its leaves.
  void PriceLeaves() {
    for (const auto& [line_number, leaves] : leaves_) {
      const BillLine& line = plan_.bill.lines[line_number];
      if (line.price.currency.empty()) continue;
      std::vector<double> pieces;
      for (const int leaf : leaves) pieces.push_back(At(leaf).total_quantity);
      const std::vector<double> shares = SharedUnits(MinorUnits(line.price), pieces);
      for (std::size_t i = 0; i < leaves.size(); ++i) {
        At(leaves[i]).price = FromMinorUnits(shares[i], line.price.currency);
        At(leaves[i]).unit_price = RoundAsMoney(line.unit_price);
      }
    }
  }

  void PriceWhatHoldsThem() {
    std::vector<std::vector<int>> children(tree_.nodes.size());
    for (int i = 1; i < static_cast<int>(tree_.nodes.size()); ++i) {
      children[static_cast<std::size_t>(At(i).parent)].push_back(i);
    }
    for (int i = static_cast<int>(tree_.nodes.size()) - 1; i >= 0; --i) {
      const std::vector<int>& below = children[static_cast<std::size_t>(i)];
      if (below.empty()) continue;
      const std::string currency = At(below.front()).price.currency;
      const bool is_known =
          !currency.empty() && std::all_of(below.begin(), below.end(),
                                           [&](int c) { return At(c).price.currency == currency; });
      if (!is_known) continue;
      double units = 0;
      for (const int child : below) units += MinorUnits(At(child).price);
      At(i).price = FromMinorUnits(units, currency);
      At(i).unit_price = RoundAsMoney({currency, At(i).price.amount / At(i).total_quantity});
    }
  }

  const FabricationPlan& plan_;
  const Design& design_;
  const Items& items_;
  const std::vector<std::map<Ware, double>> shares_;  // of each part
  const std::map<std::string, std::vector<std::string>> pictures_;
  std::map<Ware, std::size_t> line_of_ware_;
  std::map<std::string, std::size_t> line_of_part_;
  std::set<std::string> drilled_;
  std::vector<std::vector<std::size_t>> parts_in_, parts_below_;  // of each group
  std::vector<int> children_;                                     // of each node, so far
  std::map<std::size_t, std::vector<int>> leaves_;                // of each line
  BillTree tree_;
};

}  // namespace

BillTree MakeBillTree(const FabricationPlan& plan, const Design& design, const Items& items,
                      const BillSubject& subject) {
  return TreeMaker(plan, design, items).Make(subject);
}

}  // namespace mortise::fabplanner
