// Keeps the tracks of a discovery that are under way: the sources of points that it asks side by
// side, the oldest first.
//
// A track is a local optimisation, the expansion after it, or another source of points
// (track_scheduler.h). Its points are answered in the order in which it asked for them. A point
// whose design has been evaluated, or is under way for another track, is not evaluated again.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "services/pareto/archive/archive.h"
#include "services/pareto/discovery/track_scheduler.h"
#include "services/pareto/sources/local_optimization.h"
#include "services/pareto/sources/patch_sampling.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

struct Track {
  // A point that was asked for.
  struct Asked {
    std::int64_t number = -1;               // of the proposal that answers it, while under way
    std::optional<std::size_t> entry = {};  // what answers it, once that is known
  };

  std::unique_ptr<PointSource> source;
  LocalOptimization* optimization = nullptr;  // the source, if it is one
  PatchSampling* patch = nullptr;             // the source, if it is one
  TrackKind kind = TrackKind::kOpening;
  double gain = 0;      // hypervolume that it brought
  int evaluations = 0;  // that it took
  std::deque<Asked> asked = {};
};

class TrackPool {
 public:
  // What is known of a design: the entry that it is, or the number of its proposal under way.
  struct KnownDesign {
    std::optional<std::size_t> entry = {};
    std::optional<std::int64_t> number = {};
  };
  using FindDesign = std::function<KnownDesign(const Eigen::VectorXd& u)>;

  // A point that is new, and the track that asks for it.
  struct Request {
    std::int64_t track = 0;
    Eigen::VectorXd u;
  };

  // Begins a track; returns its number.
  std::int64_t Start(std::unique_ptr<PointSource> source, TrackKind kind);
  std::int64_t Start(std::unique_ptr<LocalOptimization> optimization, TrackKind kind);
  std::int64_t Start(std::unique_ptr<PatchSampling> patch, TrackKind kind);

  // Begins the round of the finishing (front_finishing.h), of which there is one at a time; it is
  // asked before all other tracks.
  void StartFinishing(std::unique_ptr<PointSource> round);
  bool IsFinishing() const { return tracks_.contains(kFinishing); }

  // Returns how many tracks have begun, without the rounds of the finishing.
  std::int64_t started() const { return next_; }
  std::size_t size() const { return tracks_.size(); }
  bool empty() const { return tracks_.empty(); }

  // Whether any track is such.
  bool HasAny(const std::function<bool(const Track&)>& is_such) const;

  // Returns the next new point of the oldest track that has one; with `only_polishes`, of those
  // tracks alone that polish. `number` is that of the proposal which it will be. Points that are
  // known by `find` are answered with what is known.
  std::optional<Request> Ask(Archive& archive, std::int64_t number, const FindDesign& find,
                             bool only_polishes);

  // Returns the next new point of one track.
  std::optional<Request> AskOne(std::int64_t track, Archive& archive, std::int64_t number,
                                const FindDesign& find);

  // Counts an evaluation for a track, if that is still under way.
  void Credit(std::int64_t track, double gain);

  // Tells all tracks that have asked for the design of proposal `number` which entry it became.
  // Returns whether any had.
  bool Answer(Archive& archive, std::int64_t number, std::size_t entry);

  // Takes the tracks that have finished out, each with a call of `retire`, which may start others.
  void RetireFinished(const std::function<void(const Track&)>& retire);

 private:
  static constexpr std::int64_t kFinishing = -2;  // before all others

  std::map<std::int64_t, Track> tracks_;  // by age
  std::int64_t next_ = 0;
};

}  // namespace mortise::pareto
