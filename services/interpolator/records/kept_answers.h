// The answers of evaluators while a map is built, in the store.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/interpolator/building/map_building.h"

namespace mortise::interpolator {

struct KeptAnswers {
  KnownAnswers answers;
  // Of each file that answers name: the design (D) that it is of, by its digest.
  std::map<std::string, Eigen::VectorXd> designs;
};

// Returns all that is kept for the build of this id, by the sampling and mapping of this version.
// DATA_LOSS where it cannot be read.
absl::StatusOr<KeptAnswers> LoadAnswers(store::Store& store, const std::string& id);

// Keeps the answers of one batch, as a record of its own. `design_of` says which design a file is
// of.
absl::Status PutAnswers(store::Transaction& transaction, const std::string& id,
                        const KnownAnswers& answers,
                        const std::function<Eigen::VectorXd(const std::string& file)>& design_of);

// Forgets all that is kept for the build.
absl::Status DropAnswers(store::Transaction& transaction, const std::string& id);

}  // namespace mortise::interpolator
