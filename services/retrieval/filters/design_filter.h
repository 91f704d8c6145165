// Whether a design is one that somebody can use: its size, what it is made of, what it costs, and
// whether there is what it takes.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/design/costs/design_cost.h"
#include "common/design/evaluated_design.h"
#include "common/design/template_definition.h"

namespace mortise::retrieval {

// What a design must be like; what is not set, every design is.
struct DesignFilter {
  // m, of the box around the design along its axes; a nanometre too much or too little is none.
  Eigen::Vector3d min_size = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_size = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  // materials/{id} of all parts, but for those that only hold others together.
  std::optional<std::set<std::string>> materials = {};
  // What its material costs at most (common/design/costs/design_cost.h), in this currency.
  std::optional<parametric::Cost> max_price = {};
  // What it can be built from: pieces as sold by items/{id}, infinity where there are as many as it
  // takes. All parts and pegs are of these, and take no more, waste not counted.
  std::optional<std::map<std::string, double>> items = {};
};

// Whether nothing is set.
bool IsEmpty(const DesignFilter& filter);

// Whether there can be a design of these items and materials that meets the filter: false only
// where there is none. It is told without making one.
bool MayMeet(const DesignFilter& filter, const std::vector<std::string>& items,
             const std::vector<std::string>& materials);

// What filters look at of a design.
struct DesignFacts {
  bool has_parts = false;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // m, of the box around it
  // materials/{id} of all parts, but for those that only hold others together.
  std::set<std::string> materials;
  // Nothing where it is not known.
  std::optional<parametric::Cost> cost;
  // What it takes of its items; nothing where a part is made of none.
  std::optional<std::vector<parametric::ItemNeed>> needs;
};

// `items` are those of the design's template.
DesignFacts FactsOf(const parametric::EvaluatedDesign& design,
                    const std::vector<parametric::Item>& items);

// Which parts of a filter a design does not meet. One without parts meets none that is set.
struct MissedParts {
  bool size = false;
  bool materials = false;
  bool price = false;
  bool items = false;

  bool Any() const { return size || materials || price || items; }
};
MissedParts MissedBy(const DesignFacts& facts, const DesignFilter& filter);

// Whether a design meets every part of the filter.
bool Meets(const DesignFilter& filter, const DesignFacts& facts);

// An item of which a design takes more than there is.
struct LackingItem {
  std::string item;  // items/{id}
  double taken = 0;  // pieces
  double there = 0;
};

// Returns what a design lacks of the items that the filter names, in the order of what it takes;
// nothing where what it takes is not known, or items are not asked about.
std::vector<LackingItem> LackingItems(const DesignFilter& filter, const DesignFacts& facts);

}  // namespace mortise::retrieval
