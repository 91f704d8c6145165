// What of shapes takes long, on threads of its own: canonical meshes are made, designs brought into
// them, interpolated shapes compared with true ones. Private to this folder.
//
// Asked for something, it says what is known, or sets to work and says so later. Whoever asks comes
// again when something has been found out: so what is decided from the answers depends neither on
// the order in which they come nor on who found them out, this run or one before.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "common/base/thread_pool.h"
#include "common/evaluation/failures/failure_tally.h"
#include "services/interpolator/building/shape_options.h"
#include "services/interpolator/building/shape_store.h"

namespace mortise::interpolator {

// A canonical mesh that was made, or why it could not be.
struct MadeMesh {
  KnownMesh known;
  std::vector<FieldKind> fields;
  std::vector<std::string> regions;  // names
  std::int64_t nodes = 0;
  std::int64_t triangles = 0;
  std::int64_t tetrahedra = 0;
  std::int64_t trait_nodes = 0;
  std::int64_t trait_elements = 0;
};

// A design by the number that it was asked for with, and its weight where others are interpolated.
struct WeightedDesign {
  std::int64_t number = 0;
  double weight = 0;
};

// All but CheckDesign is called on the thread that builds.
class ShapeWork {
 public:
  // Something that is to happen on the thread that builds; its failure stops the build.
  using Event = std::function<absl::Status()>;

  // `options` outlives it. `post`, which is called by its threads, hands an event over.
  ShapeWork(const ShapeOptions& options, std::function<void(Event)> post);

  // What an earlier run found out.
  void SetKnown(KnownShapes known) { known_ = std::move(known); }
  // The file of a design.
  void AddDesign(int structure, std::int64_t number, const std::string& digest);

  // Sets `fault` where a design cannot be part of a map, by its file. Fails where the file cannot
  // be got. Called by any thread.
  absl::Status CheckDesign(const std::string& digest, absl::Status& fault);

  // The canonical mesh made of the design `number`; null while that is not known. DATA_LOSS where
  // what is known is of another map.
  absl::StatusOr<const MadeMesh*> Mesh(const MeshKey& key, std::int64_t number);
  // The design in the mesh, which is made; null while that is not known.
  const KnownShape* Shape(const ShapeKey& key);
  // The same, without setting to work.
  const KnownShape* FindShape(const ShapeKey& key) const;
  const MadeMesh& FindMesh(const MeshKey& key) const { return meshes_.at(key); }
  // The design in the mesh compared with what is interpolated of others, all of which are in the
  // mesh; null while that is not known.
  const KnownDifference* Difference(const DifferenceKey& key,
                                    const std::vector<WeightedDesign>& others);

  const KnownDifference& FindDifference(const DifferenceKey& key) const {
    return known_.differences.at(key);
  }

  // Hands what has been found out since the last time to `keep`.
  absl::Status Keep();
  // From now on only what is known is read, which is quick; all else waits until it is released.
  void Hold() { is_held_ = true; }
  void Release();
  // Whether nothing more comes before it is released.
  bool IsHeldUp() const { return under_way_.size() == held_.size(); }
  // What is not begun is left, and failures do not count any more.
  void Stop();
  // How much is under way or waits for a thread, and of that how many designs to be mapped.
  int under_way() const { return static_cast<int>(under_way_.size()); }
  std::int64_t to_map() const { return to_map_; }
  std::int64_t mapped() const { return mapped_; }
  std::int64_t failed() const { return failed_; }
  // Why designs could not be brought into meshes, nor meshes be made of them; without the designs.
  const std::vector<evaluation::FailureCount>& failures() const { return failures_.failures(); }

 private:
  // What it is named by while it is under way.
  using Name = std::pair<int, DifferenceKey>;

  bool IsUnderWay(const Name& name) const { return under_way_.contains(name); }
  void Count(const ShapeKey& key, const KnownShape& shape);
  void CountFailure(const absl::Status& status);
  void Submit(const Name& name, bool is_known, std::function<Event()> work);
  absl::StatusOr<MadeMesh> MakeMesh(const KnownMesh& known, const std::string& design);
  absl::StatusOr<KnownShape> Bring(const std::string& design, const std::string& mesh);
  absl::StatusOr<KnownDifference> Compare(
      const std::string& design, const std::string& mesh, const std::string& truth,
      const std::vector<std::pair<std::string, double>>& others);
  const std::string& FileOf(int structure, std::int64_t number) const {
    return files_.at({structure, number});
  }

  const ShapeOptions& options_;
  const std::function<void(Event)> post_;
  ShapeStore store_;
  std::map<std::pair<int, std::int64_t>, std::string> files_;
  KnownShapes known_;
  KnownShapes fresh_;  // of that what is to be kept
  std::map<MeshKey, MadeMesh> meshes_;
  std::set<Name> under_way_;
  bool is_held_ = false;
  std::vector<std::function<void()>> held_;  // of what is under way
  std::set<ShapeKey> counted_;
  evaluation::FailureTally failures_;
  std::int64_t to_map_ = 0, mapped_ = 0, failed_ = 0;
  std::atomic<bool> is_stopped_ = false;
  ThreadPool threads_;  // the last: it ends before what its work uses
};

}  // namespace mortise::interpolator
