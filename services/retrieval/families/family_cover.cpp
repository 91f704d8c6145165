#include "services/retrieval/families/family_cover.h"

namespace mortise::retrieval {
namespace {

constexpr double kDeltaOfScale = 0.25;
constexpr std::uint64_t kSeed = 1;
constexpr int kMaxPrimitives = 1'000;
constexpr long kMaxEvaluations = 8'000;
constexpr long kMaxMeshings = 800;

}  // namespace

double DefaultDelta(const Descriptor& descriptor) {
  return kDeltaOfScale * descriptor.properties().natural_scale;
}

CoverOptions FamilyCoverOptions(double delta, const templates::Template& function) {
  CoverOptions options;
  options.delta = delta;
  options.seed = kSeed;
  options.most_primitives = kMaxPrimitives;
  options.most_evaluations = function.MeshesAnew() ? kMaxMeshings : kMaxEvaluations;
  return options;
}

}  // namespace mortise::retrieval
