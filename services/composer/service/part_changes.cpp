#include "services/composer/service/part_changes.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "common/messages/vector_codec.h"

namespace mortise::composer {
namespace {

constexpr double kMoved = 1e-9;  // m

double Apart(const v1::Vector3& a, const v1::Vector3& b) {
  return (VectorFromProto(a) - VectorFromProto(b)).cwiseAbs().maxCoeff();
}

}  // namespace

void AddChanges(const std::vector<v1::ModelPart>& before, const std::vector<v1::ModelPart>& after,
                v1::DragPreview* preview) {
  std::unordered_map<std::string, const v1::ModelPart*> left;
  for (const v1::ModelPart& part : before) left.emplace(part.name(), &part);
  for (const v1::ModelPart& part : after) {
    const auto found = left.find(part.name());
    if (found == left.end()) {
      *preview->add_added() = part;
      continue;
    }
    const v1::ModelPart& was = *found->second;
    if (std::max(Apart(was.minimum(), part.minimum()), Apart(was.maximum(), part.maximum())) >
        kMoved) {
      v1::MovedPart* const moved = preview->add_moved();
      moved->set_name(part.name());
      *moved->mutable_minimum() = part.minimum();
      *moved->mutable_maximum() = part.maximum();
    }
    left.erase(found);
  }
  for (const v1::ModelPart& part : before) {
    if (left.contains(part.name())) preview->add_removed(part.name());
  }
}

}  // namespace mortise::composer
