#include "services/catalog/records/parametrization_cache.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/assembly/memory_use.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "services/catalog/records/search_records.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {

namespace {

using templates::Parametrization;

// A digest says nothing of the assembly's name, which is checked as well, nor whether the shapes
// are there that it names.
std::string KeyOf(const v1::Assembly& assembly, const std::string& group) {
  return absl::StrCat(assembly.name(), "/", assembly.digest(), "/", group);
}

}  // namespace

absl::StatusOr<Parametrization> ParametrizationCache::Make(
    const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
    const std::string& group, const parametric::SearchProgress& progress) {
  MORTISE_RETURN_IF_ERROR(CheckShapesTogether(bundle.shapes()));
  const Searched searched{bundle.assembly().digest(), group};
  const bool is_kept = store_ != nullptr && !searched.digest.empty();
  std::optional<parametric::SearchOutcome> outcome;
  if (is_kept) outcome = FindSearchOutcome(*store_, searched);
  parametric::SearchOptions search;
  if (outcome) search.outcome = &*outcome;
  if (progress) search.progress = progress;
  MORTISE_ASSIGN_OR_RETURN(Parametrization made,
                           parametric::ParametrizeWith(search, bundle, is_given_up, group));
  if (is_kept && !outcome) Keep(searched, made);
  return made;
}

void ParametrizationCache::Keep(const Searched& searched, const Parametrization& made) {
  const absl::Status kept = KeepSearchOutcome(*store_, searched, made->search_outcome());
  if (kept.ok()) return;
  if (DetailOf(kept).reason == "TRANSACTION_NESTED") {
    const std::lock_guard lock(mutex_);
    unkept_.emplace_back(searched, made);
    return;
  }
  // Whoever asks after a restart waits once more.
  Log(LogLevel::kWarning, "what was found of an assembly could not be kept",
      {{"digest", searched.digest}, {"error", kept.ToString()}});
}

void ParametrizationCache::KeepWhatWasFound() {
  std::vector<std::pair<Searched, Parametrization>> found;
  {
    const std::lock_guard lock(mutex_);
    found.swap(unkept_);
  }
  for (const auto& [searched, made] : found) Keep(searched, made);
}

absl::StatusOr<Parametrization> ParametrizationCache::Find(
    v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
    const std::function<absl::Status(v1::AssemblyBundle&)>& complete, const std::string& group,
    const parametric::SearchProgress& progress) {
  using Made = SingleFlightCache<Parametrization>::Made;
  return parametrized_.Get(KeyOf(bundle.assembly(), group), [&]() -> absl::StatusOr<Made> {
    MORTISE_RETURN_IF_ERROR(complete(bundle));
    MORTISE_ASSIGN_OR_RETURN(Parametrization made, Make(bundle, is_given_up, group, progress));
    const std::size_t bytes = parametric::MemoryUse(*made);
    return Made{std::move(made), bytes};
  });
}

absl::StatusOr<Parametrization> ParametrizationCache::Get(
    v1::AssemblyBundle bundle, const std::function<bool()>& is_given_up,
    const std::function<absl::Status(v1::AssemblyBundle&)>& complete, const std::string& group) {
  return Find(std::move(bundle), is_given_up, complete, group, {});
}

absl::StatusOr<Parametrization> ParametrizationCache::Get(
    const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
    const std::string& group, const parametric::SearchProgress& progress) {
  if (!MissingShapes(bundle.assembly(), bundle.items(), bundle.shapes()).empty()) {
    return Make(bundle, is_given_up, group, progress);
  }
  return Find(
      bundle, is_given_up, [](v1::AssemblyBundle&) { return absl::OkStatus(); }, group, progress);
}

templates::Parametrize ParametrizationCache::ForTemplates() {
  return [this](const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
                const std::string& group) { return Get(bundle, is_given_up, group); };
}

}  // namespace mortise::catalog
