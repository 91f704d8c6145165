#include "services/pareto/discovery/track_pool.h"

#include <algorithm>
#include <utility>

namespace mortise::pareto {
namespace {

// Tells a track its answers, as far as those of the points asked for before them are known.
void TellInOrder(Archive& archive, Track& track) {
  while (!track.asked.empty() && track.asked.front().entry) {
    const std::size_t entry = *track.asked.front().entry;
    track.asked.pop_front();
    track.source->Tell(archive, entry);
  }
}

std::optional<Eigen::VectorXd> NextPoint(Track& track, Archive& archive, std::int64_t number,
                                         const TrackPool::FindDesign& find) {
  while (std::optional<Eigen::VectorXd> u = track.source->Ask(archive)) {
    const TrackPool::KnownDesign known = find(*u);
    if (known.entry) {
      track.asked.push_back({.entry = known.entry});
      TellInOrder(archive, track);
    } else if (known.number) {
      track.asked.push_back({.number = *known.number});
    } else {
      track.asked.push_back({.number = number});
      return u;
    }
  }
  return std::nullopt;
}

}  // namespace

std::int64_t TrackPool::Start(std::unique_ptr<PointSource> source, TrackKind kind) {
  tracks_[next_] = {.source = std::move(source), .kind = kind};
  return next_++;
}

std::int64_t TrackPool::Start(std::unique_ptr<LocalOptimization> optimization, TrackKind kind) {
  LocalOptimization* const view = optimization.get();
  tracks_[next_] = {.source = std::move(optimization), .optimization = view, .kind = kind};
  return next_++;
}

std::int64_t TrackPool::Start(std::unique_ptr<PatchSampling> patch, TrackKind kind) {
  PatchSampling* const view = patch.get();
  tracks_[next_] = {.source = std::move(patch), .patch = view, .kind = kind};
  return next_++;
}

void TrackPool::StartFinishing(std::unique_ptr<PointSource> round) {
  tracks_[kFinishing] = {.source = std::move(round), .kind = TrackKind::kFinishing};
}

bool TrackPool::HasAny(const std::function<bool(const Track&)>& is_such) const {
  return std::ranges::any_of(tracks_, [&](const auto& each) { return is_such(each.second); });
}

std::optional<TrackPool::Request> TrackPool::Ask(Archive& archive, std::int64_t number,
                                                 const FindDesign& find, bool only_polishes) {
  for (auto& [id, track] : tracks_) {
    if (only_polishes && id != kFinishing && track.kind != TrackKind::kPolish) continue;
    if (std::optional<Eigen::VectorXd> u = NextPoint(track, archive, number, find)) {
      return Request{id, *std::move(u)};
    }
  }
  return std::nullopt;
}

std::optional<TrackPool::Request> TrackPool::AskOne(std::int64_t track, Archive& archive,
                                                    std::int64_t number, const FindDesign& find) {
  std::optional<Eigen::VectorXd> u = NextPoint(tracks_.at(track), archive, number, find);
  if (!u) return std::nullopt;
  return Request{track, *std::move(u)};
}

void TrackPool::Credit(std::int64_t track, double gain) {
  const auto at = tracks_.find(track);
  if (at == tracks_.end()) return;
  at->second.gain += gain;
  ++at->second.evaluations;
}

bool TrackPool::Answer(Archive& archive, std::int64_t number, std::size_t entry) {
  bool was_asked = false;
  for (auto& [id, track] : tracks_) {
    for (Track::Asked& asked : track.asked) {
      if (asked.number != number) continue;
      asked.entry = entry;
      was_asked = true;
    }
    TellInOrder(archive, track);
  }
  return was_asked;
}

void TrackPool::RetireFinished(const std::function<void(const Track&)>& retire) {
  for (auto at = tracks_.begin(); at != tracks_.end();) {
    if (!at->second.source->Finished()) {
      ++at;
      continue;
    }
    const Track track = std::move(at->second);
    at = tracks_.erase(at);
    retire(track);
  }
}

}  // namespace mortise::pareto
