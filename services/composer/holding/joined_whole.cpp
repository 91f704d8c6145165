// Judges how the parts of a model are joined to a whole: a graph of parts and joints.
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "absl/strings/str_cat.h"
#include "services/composer/holding/joint_rules.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

constexpr char kOwn[] = "our own rule of thumb";

// Sets of parts that grow together.
class Clusters {
 public:
  explicit Clusters(std::size_t count) : first_(count) {
    std::iota(first_.begin(), first_.end(), std::size_t{0});
  }

  // The lowest part of the cluster.
  std::size_t Of(std::size_t part) const {
    while (first_[part] != part) part = first_[part];
    return part;
  }

  void Join(std::size_t a, std::size_t b) {
    a = Of(a);
    b = Of(b);
    first_[std::max(a, b)] = std::min(a, b);
  }

  // By their lowest part.
  std::map<std::size_t, std::vector<std::size_t>> All() const {
    std::map<std::size_t, std::vector<std::size_t>> all;
    for (std::size_t part = 0; part < first_.size(); ++part) all[Of(part)].push_back(part);
    return all;
  }

 private:
  std::vector<std::size_t> first_;
};

// What holds two clusters together, or one to all others.
struct Held {
  std::vector<const Fastener*> pins;
  bool firmly = false;  // by hardware, or by what is to move

  bool OnOneAxis() const {
    return !firmly && !pins.empty() && std::all_of(pins.begin(), pins.end(), [&](const auto* pin) {
      return AreCoaxial(*pin, *pins.front());
    });
  }
};

class WholeJudge {
 public:
  WholeJudge(const std::vector<std::string>& parts, const std::vector<Joint>& joints)
      : parts_(parts), joints_(joints) {
    for (std::size_t i = 0; i < parts.size(); ++i) index_of_[parts[i]] = i;
    FindStanding();
  }

  std::vector<Finding> Judge() {
    const Clusters touching = Joined([](const Joint&) { return true; });
    AddRest(touching, Severity::kFault, kUnconnected, "not even touching the rest");
    const Clusters fastened = Joined([](const Joint& joint) { return !joint.fasteners.empty(); });
    // What does not even touch is told of already.
    for (const auto& [first, members] : Apart(fastened)) {
      if (IsRest(touching, first)) {
        Add(Severity::kWarning, kOnlyTouches, members,
            "nothing fastens it to what it touches; whether it is glued is not known", 0, 1);
      }
    }
    AddTurning();
    return std::move(findings_);
  }

 private:
  template <typename Counts>
  Clusters Joined(const Counts& counts) const {
    Clusters clusters(parts_.size());
    for (const Joint& joint : joints_) {
      if (!counts(joint)) continue;
      for (const JoinedPart& part : joint.principals) {
        clusters.Join(index_of_.at(joint.principals.front().name), index_of_.at(part.name));
      }
    }
    return clusters;
  }

  // Finds the parts that stand on the floor, by themselves or by what is fastened to them, as
  // castors are.
  void FindStanding() {
    double floor = std::numeric_limits<double>::infinity();
    const auto lowest_of = [](const Joint& joint, const JoinedPart& part) {
      double lowest = part.box.minimum.z();
      for (const Fastener& fastener : joint.fasteners) {
        lowest = std::min(lowest, fastener.box.minimum.z());
      }
      return lowest;
    };
    for (const Joint& joint : joints_) {
      for (const JoinedPart& part : joint.principals)
        floor = std::min(floor, lowest_of(joint, part));
    }
    for (const Joint& joint : joints_) {
      for (const JoinedPart& part : joint.principals) {
        if (lowest_of(joint, part) > floor + kMaxOverlap) continue;
        standing_.insert(index_of_.at(part.name));
      }
    }
  }

  // The largest cluster of those that stand.
  std::size_t RestOf(const Clusters& clusters) const {
    std::size_t rest = 0;
    std::pair<bool, std::size_t> largest;
    for (const auto& [first, members] : clusters.All()) {
      const bool stands = std::any_of(members.begin(), members.end(),
                                      [&](std::size_t part) { return standing_.contains(part); });
      if (std::pair(stands, members.size()) <= largest) continue;
      largest = {stands, members.size()};
      rest = first;
    }
    return rest;
  }

  bool IsRest(const Clusters& clusters, std::size_t part) const {
    return clusters.Of(part) == RestOf(clusters);
  }

  // The clusters but for the rest.
  std::map<std::size_t, std::vector<std::size_t>> Apart(const Clusters& clusters) const {
    auto all = clusters.All();
    all.erase(RestOf(clusters));
    return all;
  }

  void AddRest(const Clusters& clusters, Severity severity, const char* rule, const char* text) {
    for (const auto& [first, members] : Apart(clusters)) Add(severity, rule, members, text, 0, 1);
  }

  void Add(Severity severity, const char* rule, const std::vector<std::size_t>& members,
           const std::string& text, double found, double wanted) {
    Finding finding{severity, rule, {}, found, wanted, "1", text, kOwn};
    for (const std::size_t member : members) finding.parts.push_back(parts_[member]);
    findings_.push_back(std::move(finding));
  }

  static bool IsToTurn(const Joint& joint) {
    return joint.moves || std::any_of(joint.principals.begin(), joint.principals.end(),
                                      [](const JoinedPart& part) { return part.turns; });
  }

  // What holds each two clusters together, and each cluster to all others.
  void Collect(const Clusters& clusters, std::map<std::pair<std::size_t, std::size_t>, Held>& pairs,
               std::map<std::size_t, Held>& to_others) const {
    for (const Joint& joint : joints_) {
      for (const JoinedPart& a : joint.principals) {
        for (const JoinedPart& b : joint.principals) {
          const std::size_t first = clusters.Of(index_of_.at(a.name));
          const std::size_t second = clusters.Of(index_of_.at(b.name));
          if (first >= second) continue;
          Held held;
          for (const Fastener& fastener : joint.fasteners) {
            if (!fastener.IsPin() || IsToTurn(joint)) held.firmly = true;
            if (!fastener.IsPin()) continue;
            if (DepthIn(fastener, a) > kMaxOverlap && DepthIn(fastener, b) > kMaxOverlap) {
              held.pins.push_back(&fastener);
            }
          }
          for (Held* const to : {&pairs[{first, second}], &to_others[first], &to_others[second]}) {
            to->firmly = to->firmly || held.firmly;
            to->pins.insert(to->pins.end(), held.pins.begin(), held.pins.end());
          }
        }
      }
    }
  }

  void AddTurning() {
    Clusters rigid(parts_.size());
    for (bool is_changed = true; is_changed;) {
      is_changed = false;
      std::map<std::pair<std::size_t, std::size_t>, Held> pairs;
      std::map<std::size_t, Held> to_others;
      Collect(rigid, pairs, to_others);
      for (const auto& [pair, held] : pairs) {
        const bool is_rigid = held.firmly || (!held.pins.empty() && !held.OnOneAxis());
        if (!is_rigid || rigid.Of(pair.first) == rigid.Of(pair.second)) continue;
        rigid.Join(pair.first, pair.second);
        is_changed = true;
      }
    }
    std::map<std::pair<std::size_t, std::size_t>, Held> pairs;
    std::map<std::size_t, Held> to_others;
    Collect(rigid, pairs, to_others);
    const std::size_t largest = RestOf(rigid);
    const auto all = rigid.All();
    for (const auto& [first, held] : to_others) {
      if (first == largest || !held.OnOneAxis()) continue;
      Add(Severity::kWarning, "can-turn", all.at(first),
          absl::StrCat("held by ", Names(held), " alone, can turn about ",
                       held.pins.size() == 1 ? "it" : "their one axis",
                       " unless it is glued, which is not known"),
          1, 2);
    }
  }

  static std::string Names(const Held& held) {
    std::string names;
    std::set<std::string> seen;
    for (const Fastener* const pin : held.pins) {
      if (!seen.insert(pin->name).second) continue;
      absl::StrAppend(&names, names.empty() ? "'" : ", '", pin->name, "'");
    }
    return names;
  }

  const std::vector<std::string>& parts_;
  const std::vector<Joint>& joints_;
  std::map<std::string, std::size_t> index_of_;
  std::set<std::size_t> standing_;  // parts
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> JudgeWhole(const std::vector<std::string>& parts,
                                const std::vector<Joint>& joints) {
  return WholeJudge(parts, joints).Judge();
}

}  // namespace mortise::composer
