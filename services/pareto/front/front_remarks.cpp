#include "services/pareto/front/front_remarks.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace mortise::pareto {
namespace {

std::string Quoted(const std::string& name) { return absl::StrCat("'", name, "'"); }

}  // namespace

std::vector<std::string> FrontRemarks(const Archive& archive, const Front& front,
                                      const std::vector<std::string>& names) {
  std::vector<std::string> remarks;
  if (archive.feasible_count() < 2) return remarks;
  const Eigen::VectorXd range = archive.WholeRange();
  std::vector<std::string> varying;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (range[static_cast<Eigen::Index>(i)] > 0) {
      varying.push_back(Quoted(names[i]));
    } else {
      remarks.push_back(absl::StrCat(Quoted(names[i]), " is the same for all ",
                                     archive.feasible_count(), " designs that could be compared"));
    }
  }
  const Eigen::VectorXd& best = archive[archive.non_dominated().front()].metrics;
  const bool agree = std::ranges::all_of(
      archive.non_dominated(), [&](std::size_t entry) { return archive[entry].metrics == best; });
  if (agree && varying.size() > 1) {
    remarks.push_back(absl::StrCat("one design is the best in ", absl::StrJoin(varying, " and "),
                                   ": these do not conflict, and the front is a single point"));
  } else if (front.points.size() == 1) {
    remarks.push_back("the front is a single point");
  }
  return remarks;
}

}  // namespace mortise::pareto
