#include "tests/bench/services/retrieval/evaluation/family_covers.h"

#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "services/retrieval/families/family_manifold.h"
#include "services/retrieval/index/index_file.h"
#include "tests/bench/services/retrieval/evaluation/remembering_manifold.h"

namespace mortise::retrieval {
namespace {

// In the order in which they were found, from the index of one family.
std::vector<Primitive> PrimitivesOf(const PrimitiveIndex& index) {
  const auto entries = index.arrays().primitives;
  std::vector<Primitive> primitives(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    primitives[static_cast<std::size_t>(entries[i].number)] =
        index.PrimitiveOf({.family = 0, .entry = static_cast<int>(i)});
  }
  return primitives;
}

}  // namespace

std::filesystem::path FamilyCovers::PathOf(const EvaluationFamily& family,
                                           const Descriptor& descriptor, double delta) const {
  const std::string content = absl::StrJoin(
      std::make_tuple(family.name, family.function->head().digest, descriptor.properties().name,
                      descriptor.properties().dimension, absl::StrFormat("%a", delta),
                      options_.rejections, options_.most_primitives, options_.most_evaluations,
                      options_.seed, static_cast<int>(options_.kind)),
      " ");
  return folder_ / absl::StrCat("cover-", Sha256Hex(content).substr(0, 24));
}

absl::StatusOr<std::vector<std::vector<Primitive>>> FamilyCovers::Of(
    const EvaluationFamily& family, const std::shared_ptr<const Descriptor>& descriptor,
    const std::vector<double>& deltas) const {
  std::unique_ptr<Manifold> manifold;
  std::vector<std::vector<Primitive>> covers;
  for (const double delta : deltas) {
    const std::string& name = descriptor->properties().name;
    const std::filesystem::path path = PathOf(family, *descriptor, delta);
    if (const absl::StatusOr<StoredIndex> kept = ReadIndex(path, name); kept.ok()) {
      covers.push_back(PrimitivesOf(kept->index));
      continue;
    }
    if (!manifold) {
      MORTISE_ASSIGN_OR_RETURN(manifold, MakeFamilyManifold(family.function, descriptor));
      manifold = std::make_unique<RememberingManifold>(std::move(manifold));
    }
    CoverOptions options = options_;
    options.delta = delta;
    MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverManifold(*manifold, options));
    std::vector<FamilyCover> one;
    one.push_back({.family = 0, .primitives = std::move(cover.primitives)});
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex index, PrimitiveIndex::Build(std::move(one)));
    MORTISE_RETURN_IF_ERROR(WriteIndex(index, name, family.name, path));
    covers.push_back(PrimitivesOf(index));
  }
  return covers;
}

}  // namespace mortise::retrieval
