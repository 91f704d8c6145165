#include "common/assembly/codec/search_outcome_codec.h"

#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace mortise::parametric {
namespace {

using Json = nlohmann::json;

Json ToJson(const std::set<PosedPair>& pairs) {
  Json list = Json::array();
  for (const PosedPair& pair : pairs) list.push_back({pair.pose, pair.first, pair.second});
  return list;
}

std::set<PosedPair> PosedPairsFrom(const Json& list) {
  std::set<PosedPair> pairs;
  for (const Json& pair : list) {
    pairs.insert({pair.at(0).get<std::string>(), pair.at(1).get<int>(), pair.at(2).get<int>()});
  }
  return pairs;
}

SearchOutcome Read(const Json& document) {
  SearchOutcome outcome;
  outcome.touching = document.at("touching").get<TouchingParts>();
  outcome.pattern_losses = document.at("pattern_losses").get<PatternLosses>();
  outcome.repair_plan.lone = document.at("lone").get<std::set<int>>();
  KnownConflicts& conflicts = outcome.repair_plan.known_conflicts;
  conflicts.kept_apart = PosedPairsFrom(document.at("kept_apart"));
  conflicts.kept_touching = PosedPairsFrom(document.at("kept_touching"));
  conflicts.fitted = PosedPairsFrom(document.at("fitted"));
  for (const Json& kept : document.at("shares_kept")) {
    const std::pair<int, Axis> place(kept.at(0).get<int>(),
                                     static_cast<Axis>(kept.at(1).get<int>()));
    conflicts.shares_kept[place] = kept.at(2).get<int>();
  }
  return outcome;
}

}  // namespace

std::string ToText(const SearchOutcome& outcome) {
  const KnownConflicts& conflicts = outcome.repair_plan.known_conflicts;
  Json shares = Json::array();
  for (const auto& [place, kept] : conflicts.shares_kept) {
    shares.push_back({place.first, static_cast<int>(place.second), kept});
  }
  const Json document = {{"version", kSearchVersion},
                         {"touching", outcome.touching},
                         {"pattern_losses", outcome.pattern_losses},
                         {"lone", outcome.repair_plan.lone},
                         {"kept_apart", ToJson(conflicts.kept_apart)},
                         {"kept_touching", ToJson(conflicts.kept_touching)},
                         {"fitted", ToJson(conflicts.fitted)},
                         {"shares_kept", std::move(shares)}};
  return document.dump();
}

std::optional<SearchOutcome> SearchOutcomeFrom(std::string_view text) {
  const Json document = Json::parse(text, nullptr, false);
  if (!document.is_object()) return std::nullopt;
  try {
    if (document.value("version", 0) != kSearchVersion) return std::nullopt;
    return Read(document);
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace mortise::parametric
