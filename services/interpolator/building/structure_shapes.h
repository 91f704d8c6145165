// The shapes of one structure's map: which canonical mesh each element has, and how far what is
// interpolated in it is off. Private to this folder.
//
// A canonical mesh serves as many elements as it can. The first is that of the design at the centre
// of the box; parts of an element inherit its mesh. An element whose samples and probes cannot all
// be brought into the mesh that it inherits tries those of elements beside it, and then that of the
// design at its own centre, which has been evaluated as a probe. If that fails as well, the element
// is told to have failed: it has its metrics alone then, and is split. All that is decided here
// follows from the answers alone: the same answers give the same meshes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/maps/map_sampling.h"
#include "services/interpolator/building/mesh_noise.h"
#include "services/interpolator/building/shape_options.h"
#include "services/interpolator/building/shape_work.h"
#include "services/interpolator/building/shaped_structure.h"

namespace mortise::interpolator {

class StructureShapes {
 public:
  // All outlive it.
  StructureShapes(int structure, maps::MapSampling& sampling, ShapeWork& work,
                  const ShapeOptions& options);

  // Noise floors beside those of the options.
  void SetNoise(MeshNoise noise) { noise_ = std::move(noise); }

  // To be called when a point has been told that did not fail: its design is brought into the
  // meshes around it ahead of time.
  absl::Status Told(int number);
  // Goes on as far as what is known allows, and tells the errors that are awaited when all of them
  // are. Fails as the work does.
  absl::Status Advance();

  // Of the map's last complete round, which there is.
  absl::StatusOr<ShapedStructure> Result() const;
  // How many canonical meshes its elements have.
  int mesh_count() const;

 private:
  struct Probe {
    DifferenceKey key;
    std::vector<WeightedDesign> samples;
  };
  // What is known of an element that is interpolated.
  struct Settled {
    int mesh = 0;
    std::vector<DifferenceKey> differences{};  // at its probes
    Eigen::MatrixXd bending{};                 // K × quantities: the shape, then the fields
  };
  // An element whose error is awaited, on the way to a mesh.
  struct Attempt {
    enum class State { kTrying, kFits, kFails };
    State state = State::kTrying;
    int mesh = -1;             // that is tried
    std::vector<int> tried{};  // before
    std::vector<Probe> probes{};
  };
  enum class Outcome { kWaits, kFits, kFails };
  using Elements = std::map<int, std::shared_ptr<const Settled>>;

  absl::Status BringAhead();
  void Inherit();
  int MeshOf(int number);
  int CentreProbe(int element) const;
  std::vector<int> PointsOf(int element) const;
  int FittingMesh(int element) const;
  int NextMesh(int element, const Attempt& attempt);
  absl::StatusOr<Outcome> Try(int element, const Attempt& attempt);
  absl::StatusOr<bool> Settle();
  absl::StatusOr<bool> TryOthers(int element, Attempt& attempt);
  absl::StatusOr<bool> IsTriedOut(int element);
  void Accept(int element, Attempt& attempt);
  bool Measure();
  std::vector<Probe> ProbesIn(int element, int mesh) const;
  absl::Status Tell();
  bool IncludeRanges();
  Eigen::MatrixXd BendingOf(int element, int mesh) const;
  Eigen::VectorXd ScalesOf(const Settled& settled) const;
  double NoiseFloorOf(Eigen::Index quantity, double scale) const;
  maps::OutsideError OutsideErrorOf(const Settled& settled) const;
  Eigen::VectorXd DividingDirections(int element);
  ShapedStructure::Mesh DescriptionOf(int mesh) const;
  void AddShapes(const std::vector<int>& samples, int mesh, int place,
                 ShapedStructure& result) const;
  void AddErrors(const std::set<DifferenceKey>& probes, ShapedStructure& result) const;
  std::int64_t CountUnmapped(const maps::RefinementTree& tree,
                             const std::vector<int>& element_mesh) const;
  MeshKey KeyOf(int mesh) const { return {structure_, mesh}; }

  const int structure_;
  maps::MapSampling& sampling_;
  ShapeWork& work_;
  const ShapeOptions& options_;
  MeshNoise noise_;
  std::vector<int> mesh_designs_;            // of each mesh the number of its design
  std::vector<int> node_mesh_;               // of each node of the tree, -1 where there is none yet
  std::vector<int> told_;                    // points that did not fail
  std::set<std::pair<int, int>> ahead_;      // meshes and points to be brought into them
  std::vector<FieldKind> fields_;            // of all its meshes,
  bool has_fields_ = false;                  // once there is one
  std::map<int, Attempt> attempts_;          // of the elements whose errors are awaited
  std::vector<FieldRange> ranges_;           // of each field, of all that is interpolated
  Elements settled_;                         // that are interpolated
  Elements complete_;                        // when the last round was complete
  std::vector<FieldRange> complete_ranges_;  // likewise
};

}  // namespace mortise::interpolator
