#include "services/composer/connecting/motions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/assembly/model/rest_pose.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::ElementConnection;
using parametric::Joint;
using parametric::JointKind;

constexpr double kParallel = 1 - 1e-6;  // cosine
constexpr std::array<const char*, 6> kMoving{"drawer", "door", "lid", "flap", "hatch", "gate"};
// Words of names whose last word is a part of what they name: "desk-with-drawer".
constexpr std::array<const char*, 5> kOfMore{"with", "and", "for", "without", "no"};

// The words of a name, in small letters.
std::vector<std::string> WordsOf(const std::string& name) {
  std::vector<std::string> words;
  bool goes_on = false;
  for (const char letter : name) {
    const bool is_letter = absl::ascii_isalpha(static_cast<unsigned char>(letter));
    if (is_letter && !goes_on) words.emplace_back();
    if (is_letter) words.back().push_back(absl::ascii_tolower(static_cast<unsigned char>(letter)));
    goes_on = is_letter;
  }
  return words;
}

bool Moves(const ElementConnection& connection, const Joint& joint, int principal) {
  return parametric::IsWithin(connection.assembly,
                              connection.elements[static_cast<std::size_t>(principal)].group,
                              joint.group);
}

std::vector<int> FramesOf(const Design& design, const std::vector<PrincipalPart>& parts) {
  const Assembly& assembly = design.assembly->assembly();
  std::set<int> moved;
  for (const Joint& joint : assembly.joints) moved.insert(joint.group);
  std::map<std::string, int> group_of;
  for (const auto& part : assembly.parts) group_of[part.name] = part.group;
  std::vector<int> frames;
  for (const PrincipalPart& part : parts) {
    int group = group_of.at(part.drawn_as);
    while (group > 0 && !moved.contains(group)) {
      group = assembly.groups[static_cast<std::size_t>(group)].parent;
    }
    frames.push_back(group);
  }
  return frames;
}

}  // namespace

bool IsMeantToMove(const std::string& name) {
  const std::vector<std::string> words = WordsOf(name);
  if (words.empty()) return false;
  const auto is_one_of = [](const auto& list, const std::string& word) {
    return std::find(list.begin(), list.end(), word) != list.end();
  };
  return is_one_of(kMoving, words.back()) &&
         std::none_of(words.begin(), words.end(),
                      [&](const std::string& word) { return is_one_of(kOfMore, word); });
}

const char* VerbOf(const WantedMotion& motion) {
  if (!motion.kind) return "move";
  return *motion.kind == JointKind::kPrismatic ? "slide" : "turn";
}

WantedMotion WantedMotionOf(const std::vector<PrincipalPart>& component, const std::string& name,
                            const Joint* joint) {
  if (joint != nullptr) return {true, joint->kind, absl::StrCat("by '", joint->name, "'")};
  if (IsMeantToMove(name)) return {true, std::nullopt, "by its name"};
  if (component.size() == 1 && IsMeantToMove(component.front().name)) {
    return {true, std::nullopt, absl::StrCat("by the name of '", component.front().name, "'")};
  }
  return {};
}

const Joint* OwnJointOf(const Assembly& original, const std::vector<PrincipalPart>& component) {
  std::set<std::string> own;
  for (const PrincipalPart& part : component) own.insert(part.drawn_as);
  const auto moves_it = [&](const Joint& joint) {
    return std::all_of(original.parts.begin(), original.parts.end(), [&](const auto& part) {
      return part.connecting ||
             own.contains(part.name) == parametric::IsWithin(original, part.group, joint.group);
    });
  };
  const auto found = std::find_if(original.joints.begin(), original.joints.end(), moves_it);
  return found == original.joints.end() ? nullptr : &*found;
}

AllowedMotion AllowedMotionOf(const ElementConnection& connection, int first, int second,
                              const ItemKindOf& kind_of) {
  AllowedMotion allowed;
  for (const Joint& joint : connection.assembly.joints) {
    const bool moves = Moves(connection, joint, second);
    if (moves == Moves(connection, joint, first)) continue;
    allowed.is_firm = false;
    if (moves && Guides(connection, joint, kind_of)) allowed.kinds.push_back(joint.kind);
  }
  return allowed;
}

bool Allows(const AllowedMotion& allowed, const WantedMotion& wanted) {
  if (!wanted.moves) return allowed.is_firm;
  return std::any_of(allowed.kinds.begin(), allowed.kinds.end(),
                     [&](JointKind kind) { return !wanted.kind || *wanted.kind == kind; });
}

std::optional<int> JointOfComponent(const Candidate& candidate) {
  const ElementConnection& connection = candidate.from->connection;
  const auto moves_the_component = [&](const Joint& joint) {
    for (std::size_t i = 0; i < candidate.principals.size(); ++i) {
      if (Moves(connection, joint, static_cast<int>(i)) != candidate.principals[i].of_component) {
        return false;
      }
    }
    return true;
  };
  const auto& joints = connection.assembly.joints;
  const auto found = std::find_if(joints.begin(), joints.end(), moves_the_component);
  if (found == joints.end()) return std::nullopt;
  return static_cast<int>(found - joints.begin());
}

Joint JointWhere(const Candidate& candidate, const parametric::OptimizedConnection& placed,
                 int joint) {
  const ElementConnection& connection = candidate.from->connection;
  Joint made = connection.assembly.joints[static_cast<std::size_t>(joint)];
  made.center =
      placed.q.segment<3>(parametric::JointVariable(connection.elements.size(), joint, Axis::kX));
  return made;
}

bool MoveAlike(const Joint& a, const Joint& b, double tolerance) {
  if (a.kind != b.kind) return false;
  const Eigen::Vector3d apart = a.center - b.center;
  if (a.kind == JointKind::kBall) return apart.norm() <= tolerance;
  if (std::abs(a.axis.dot(b.axis)) < kParallel) return false;
  return a.kind == JointKind::kPrismatic || apart.cross(a.axis).norm() <= tolerance;
}

std::vector<PartPair> HeldPairs(const Candidate& candidate) {
  const ElementConnection& connection = candidate.from->connection;
  std::vector<PartPair> pairs;
  if (connection.connecting.empty()) return pairs;
  const std::optional<int> its = JointOfComponent(candidate);
  const auto& joints = connection.assembly.joints;
  const auto are_moved = [&](std::size_t a, std::size_t b) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (its == static_cast<int>(j)) continue;
      if (Moves(connection, joints[j], static_cast<int>(a)) !=
          Moves(connection, joints[j], static_cast<int>(b))) {
        return true;
      }
    }
    return false;
  };
  for (std::size_t a = 0; a < candidate.principals.size(); ++a) {
    for (std::size_t b = 0; b < candidate.principals.size(); ++b) {
      const BoundPrincipal& body = candidate.principals[a];
      const BoundPrincipal& component = candidate.principals[b];
      if (body.of_component || !component.of_component || are_moved(a, b)) continue;
      pairs.emplace_back(body.part, component.part);
    }
  }
  return pairs;
}

MovingFrames::MovingFrames(const BothSides& sides)
    : body_(FramesOf(sides.body, sides.body_parts)),
      component_(FramesOf(sides.component, sides.component_parts)) {}

bool MovingFrames::BothStay(int body, int component) const {
  return body_[static_cast<std::size_t>(body)] == 0 &&
         component_[static_cast<std::size_t>(component)] == 0;
}

bool MovingFrames::MayFasten(int body, int component) const {
  const int a = body_[static_cast<std::size_t>(body)];
  const int b = component_[static_cast<std::size_t>(component)];
  const auto others = component_of_body_.find(a), its = body_of_component_.find(b);
  return (others == component_of_body_.end() || others->second == b) &&
         (its == body_of_component_.end() || its->second == a);
}

std::optional<PartPair> MovingFrames::FirstConflict(const std::vector<PartPair>& pairs) const {
  MovingFrames with_these = *this;
  for (const PartPair& pair : pairs) {
    if (!with_these.MayFasten(pair.first, pair.second)) return pair;
    with_these.Fasten(pair.first, pair.second);
  }
  return std::nullopt;
}

void MovingFrames::Fasten(int body, int component) {
  const int a = body_[static_cast<std::size_t>(body)];
  const int b = component_[static_cast<std::size_t>(component)];
  component_of_body_.emplace(a, b);
  body_of_component_.emplace(b, a);
}

}  // namespace mortise::composer
