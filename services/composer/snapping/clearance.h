// Private to this folder. Says whether a component runs into the body of a model where it would
// lie.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/composer/model/design.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {

// Looked at are principal parts; what connects them comes anew. The designs must outlive it.
class Clearance {
 public:
  // The component as it was dropped; `original` as Snap has it, or null.
  Clearance(const Design& component, const Design* original, const Design& body);

  // Returns how deep the component reaches into the body at these parameters, in space, m: the sum
  // over all parts. O(parts of the component · parts of the body) where boxes are apart.
  double OverlapAt(const Eigen::VectorXd& q) const;

  // Whether a part of the component reaches into one of the body at these parameters, in space,
  // deeper by more than kMaxOverlap than it did where it was dropped, or does into any part outside
  // of the component in the original.
  bool RunsInto(const Eigen::VectorXd& q) const;

 private:
  struct PlacedSolid {
    int element = 0;
    bool has_shape = false;  // else it fills its box
    SolidPart solid;
  };

  static std::vector<PlacedSolid> PrincipalsOf(const Design& design);
  std::vector<PlacedSolid> SolidsAt(const Eigen::VectorXd& q) const;
  bool IsDeeper(const PlacedSolid& part, std::size_t body_part) const;
  double DepthWhereDropped(const std::string& part, std::size_t body_part) const;
  double DepthInOriginal(int element) const;

  const Design& component_;
  const Design* original_;
  std::vector<PlacedSolid> body_;
  std::vector<PlacedSolid> dropped_;
  // What was asked for already.
  mutable std::map<std::pair<std::string, std::size_t>, double> where_dropped_;
  mutable std::map<int, double> in_original_;  // by element of the component
};

}  // namespace mortise::composer
