#include "common/parametric/design_trial.h"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/parametric/contact_check.h"
#include "common/parametric/rest_pose.h"

namespace mortise::parametric {
namespace {

// As many corners as take little time, of large designs the fewest.
constexpr int kFewestCorners = 24;
constexpr int kMostCorners = 250;
constexpr int kPartsLookedAt = 4000;
constexpr std::uint64_t kSeed = 1;

// Corners of the set, and points on the lines from each to the next.
absl::StatusOr<std::vector<Eigen::VectorXd>> TrialDesigns(const FeasibleSet& feasible_set,
                                                          std::size_t parts) {
  const int corners = std::clamp(kPartsLookedAt / static_cast<int>(std::max<std::size_t>(parts, 1)),
                                 kFewestCorners, kMostCorners);
  MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::VectorXd> designs,
                           feasible_set.Corners(corners, kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i + 1 < static_cast<std::size_t>(corners); ++i) {
    const double along = uniform(random);
    designs.push_back((1 - along) * designs[i] + along * designs[i + 1]);
  }
  return designs;
}

class Trial {
 public:
  Trial(const Assembly& assembly, const std::vector<Element>& elements, const Remedies& known,
        double tolerance)
      : assembly_(assembly),
        elements_(elements),
        known_(known),
        tolerance_(tolerance),
        drawn_(DrawnParameters(assembly, elements)) {}

  void Remedy(const ContactFault& fault) {
    if (!KeepApart(fault)) GiveUpPatterns(fault);
  }

  Remedies TakeRemedies() { return std::move(remedies_); }

 private:
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }

  bool KeepApart(const ContactFault& fault) {
    if (fault.kind != ContactFault::Kind::kPenetration || fault.pose.empty()) return false;
    const std::vector<Pose> poses = PosesOf(assembly_);
    const auto pose = std::find_if(poses.begin(), poses.end(),
                                   [&](const Pose& one) { return one.name == fault.pose; });
    const double apart =
        Separation(BoxIn(*pose, assembly_, elements_, fault.first_element, drawn_),
                   BoxIn(*pose, assembly_, elements_, fault.second_element, drawn_));
    const KeptApart pair{fault.pose, At(fault.first_element).parts.front(),
                         At(fault.second_element).parts.front()};
    if (apart < -tolerance_ || known_.kept_apart.count(pair) != 0) return false;
    remedies_.kept_apart.insert(pair);
    return true;
  }

  void GiveUpPatterns(const ContactFault& fault) {
    std::vector<int> patterns;
    for (const int element : {fault.first_element, fault.second_element}) {
      if (element >= 0 && At(element).pattern) patterns.push_back(element);
    }
    const bool fastens = std::any_of(patterns.begin(), patterns.end(),
                                     [&](int element) { return At(element).connecting; });
    for (const int element : patterns) {
      if (fastens && !At(element).connecting) continue;
      remedies_.lone.insert(At(element).parts.begin(), At(element).parts.end());
    }
  }

  const Assembly& assembly_;
  const std::vector<Element>& elements_;
  const Remedies& known_;
  const double tolerance_;
  const Eigen::VectorXd drawn_;
  Remedies remedies_;
};

}  // namespace

absl::StatusOr<Remedies> TryDesigns(const Assembly& assembly, const std::vector<Element>& elements,
                                    const FeasibleSet& feasible_set, const Remedies& known,
                                    double tolerance) {
  const bool has_patterns =
      std::any_of(elements.begin(), elements.end(),
                  [](const Element& element) { return element.pattern.has_value(); });
  if (!has_patterns && PosesOf(assembly).size() == 1) return Remedies();
  Assembly boxes = assembly;
  for (AssemblyPart& part : boxes.parts) part.shape = nullptr;
  const ContactCheck check(std::move(boxes), elements, tolerance);
  Trial trial(assembly, elements, known, tolerance);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::VectorXd> designs,
                           TrialDesigns(feasible_set, assembly.parts.size()));
  for (const Eigen::VectorXd& q : designs) {
    if (!check.CheckParameters(q).ok()) continue;  // more parts than anybody may ask for
    MORTISE_ASSIGN_OR_RETURN(const std::vector<ContactFault> faults, check.FaultsAt(q));
    for (const ContactFault& fault : faults) trial.Remedy(fault);
  }
  return trial.TakeRemedies();
}

}  // namespace mortise::parametric
