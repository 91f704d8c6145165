// Covers of families, kept in a folder between runs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold_cover.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "tests/bench/services/retrieval/evaluation/evaluation_families.h"

namespace mortise::retrieval {

class FamilyCovers {
 public:
  // `options`: of all covers, but for δ.
  FamilyCovers(std::filesystem::path folder, CoverOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}

  // The primitives of a family for each δ: those that are kept, else made now and kept.
  absl::StatusOr<std::vector<std::vector<Primitive>>> Of(
      const EvaluationFamily& family, const std::shared_ptr<const Descriptor>& descriptor,
      const std::vector<double>& deltas) const;

 private:
  std::filesystem::path PathOf(const EvaluationFamily& family, const Descriptor& descriptor,
                               double delta) const;

  std::filesystem::path folder_;
  CoverOptions options_;
};

}  // namespace mortise::retrieval
