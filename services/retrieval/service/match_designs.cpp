#include "services/retrieval/service/match_designs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/rpc/channel.h"

namespace mortise::retrieval {
namespace {

constexpr absl::Duration kLongest = absl::Seconds(20);
constexpr std::size_t kBytesOfEntry = 200;

// Names a design: of a revision, which never changes, at parameters, to the bit.
std::string KeyOf(const v1::ShapeIndex::Family& family, const Eigen::VectorXd& parameters) {
  std::string key =
      absl::StrCat(family.template_(), "/", family.template_revision(), "/", family.group(), "/");
  key.append(reinterpret_cast<const char*>(parameters.data()),
             static_cast<std::size_t>(parameters.size()) * sizeof(double));
  return key;
}

void Count(const MissedParts& missed, FilterTally* tally) {
  if (!missed.size) ++tally->of_size;
  if (!missed.materials) ++tally->of_materials;
  if (!missed.price) ++tally->of_price;
  if (!missed.items) ++tally->of_items;
}

std::size_t BytesOf(const std::string& key, const DesignFacts& facts) {
  std::size_t bytes = kBytesOfEntry + 2 * key.size() + sizeof facts;
  for (const std::string& each : facts.materials) bytes += kBytesOfEntry + each.size();
  if (!facts.needs) return bytes;
  for (const parametric::ItemNeed& each : *facts.needs) bytes += sizeof each + each.item.size();
  return bytes;
}

}  // namespace

absl::StatusOr<MatchDesign> DesignOf(const IndexMatch& match, const LoadedIndex& index,
                                     TemplateSource& templates, const rpc::Origin& origin) {
  const v1::ShapeIndex::Family& family = index.record.families(match.family);
  MatchDesign made;
  MORTISE_ASSIGN_OR_RETURN(
      made.compiled,
      templates.Get(family.template_(), family.template_revision(), origin, family.group()));
  MORTISE_ASSIGN_OR_RETURN(made.design, made.compiled->design_template->Evaluate(
                                            index.primitives.PrimitiveOf(match).parameters));
  return made;
}

absl::StatusOr<std::shared_ptr<const DesignFacts>> MatchFacts::Get(const IndexMatch& match,
                                                                   const LoadedIndex& index,
                                                                   const rpc::Origin& origin) {
  using Made = SingleFlightCache<std::shared_ptr<const DesignFacts>>::Made;
  const std::string key =
      KeyOf(index.record.families(match.family), index.primitives.PrimitiveOf(match).parameters);
  return kept_.Get(key, [&]() -> absl::StatusOr<Made> {
    const absl::StatusOr<MatchDesign> made = DesignOf(match, index, templates_, origin);
    if (IsPassingFailure(made.status())) return made.status();
    auto facts = std::make_shared<const DesignFacts>(
        made.ok() ? FactsOf(made->design, made->compiled->design_template->head().items)
                  : DesignFacts());
    const std::size_t bytes = BytesOf(key, *facts);
    return Made{std::move(facts), bytes};
  });
}

absl::StatusOr<FilteredMatches> NearestThatMeet(const DesignFilter& filter, IndexQuery query,
                                                const LoadedIndex& index, MatchFacts& facts,
                                                const rpc::Call& call, FilterTally* tally) {
  const rpc::Origin origin = rpc::ForwardedFrom(call);
  const absl::Time now = absl::Now();
  const absl::Time end = now + std::min(kLongest, (call.deadline() - now) / 2);
  return NearestThatMeet(
      index.primitives, std::move(query),
      [&](const IndexMatch& match) -> absl::StatusOr<bool> {
        if (call.cancelled()) return absl::CancelledError("nobody waits for the answer any more");
        MORTISE_ASSIGN_OR_RETURN(const auto known, facts.Get(match, index, origin));
        const MissedParts missed = MissedBy(*known, filter);
        Count(missed, tally);
        const bool lacks_items = missed.items && !missed.size && !missed.materials && !missed.price;
        if (lacks_items && tally->lacking.empty()) {
          tally->lacking = LackingItems(filter, *known);
          tally->lacking_template = index.record.families(match.family).template_();
        }
        return !missed.Any();
      },
      {.is_time_up = [end] { return absl::Now() >= end; }});
}

}  // namespace mortise::retrieval
