#include "services/interpolator/building/structure_shapes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/base/errors.h"
#include "common/maps/local_model.h"

namespace mortise::interpolator {
namespace {

// How many meshes of elements beside it an element tries before it gets its own.
constexpr std::size_t kMostBeside = 3;

// A digest of what is interpolated (Fowler, Noll, Vo 1a).
std::uint64_t DigestOf(const std::vector<WeightedDesign>& designs) {
  std::uint64_t digest = 0xcbf29ce484222325U;
  const auto add = [&digest](std::uint64_t number) {
    for (int byte = 0; byte < 8; ++byte) {
      digest = (digest ^ (number >> (8 * byte) & 0xff)) * 0x100000001b3U;
    }
  };
  for (const WeightedDesign& design : designs) {
    add(static_cast<std::uint64_t>(design.number));
    add(std::bit_cast<std::uint64_t>(design.weight));
  }
  return digest;
}

}  // namespace

StructureShapes::StructureShapes(int structure, maps::MapSampling& sampling, ShapeWork& work,
                                 const ShapeOptions& options)
    : structure_(structure),
      sampling_(sampling),
      work_(work),
      options_(options),
      node_mesh_(1, -1) {}

absl::Status StructureShapes::Told(int number) {
  told_.push_back(number);
  if (mesh_designs_.empty() && number == CentreProbe(0)) {
    node_mesh_[0] = MeshOf(number);
    for (const int other : told_) ahead_.emplace(node_mesh_[0], other);
  }
  Inherit();
  for (const int element : sampling_.ElementsAround(number)) {
    if (node_mesh_[element] >= 0) ahead_.emplace(node_mesh_[element], number);
  }
  return BringAhead();
}

absl::Status StructureShapes::BringAhead() {
  for (auto each = ahead_.begin(); each != ahead_.end();) {
    const auto [mesh, number] = *each;
    MORTISE_ASSIGN_OR_RETURN(const MadeMesh* const made,
                             work_.Mesh(KeyOf(mesh), mesh_designs_[mesh]));
    if (made == nullptr) {
      ++each;
      continue;
    }
    if (made->known.status.ok()) work_.Shape({KeyOf(mesh), number});
    each = ahead_.erase(each);
  }
  return absl::OkStatus();
}

// Parts have the mesh of what they are parts of: the n-th split makes nodes 2n - 1 and 2n.
void StructureShapes::Inherit() {
  const auto& history = sampling_.tree().history();
  while (node_mesh_.size() < 2 * history.size() + 1) {
    node_mesh_.push_back(node_mesh_[history[(node_mesh_.size() - 1) / 2].element]);
  }
}

int StructureShapes::MeshOf(int number) {
  const auto found = std::ranges::find(mesh_designs_, number);
  if (found != mesh_designs_.end()) return static_cast<int>(found - mesh_designs_.begin());
  mesh_designs_.push_back(number);
  return static_cast<int>(mesh_designs_.size()) - 1;
}

int StructureShapes::CentreProbe(int element) const {
  const maps::ElementBox box = sampling_.tree().BoxOf(element);
  const Eigen::VectorXd centre = (box.low + box.high) / 2;
  for (const int probe : sampling_.ProbesOf(element)) {
    if (sampling_.PositionOf(probe) == centre) return probe;
  }
  return -1;
}

// The designs that an element has to do with: its samples and its probes.
std::vector<int> StructureShapes::PointsOf(int element) const {
  std::vector<int> points;
  for (const int sample : sampling_.tree().ElementSamples(element)) {
    points.push_back(sampling_.PointOfSample(sample));
  }
  const std::vector<int>& probes = sampling_.ProbesOf(element);
  points.insert(points.end(), probes.begin(), probes.end());
  return points;
}

absl::Status StructureShapes::Advance() {
  MORTISE_RETURN_IF_ERROR(BringAhead());
  while (true) {
    const std::vector<int> awaited = sampling_.AwaitedErrors();
    if (awaited.empty()) return absl::OkStatus();
    Inherit();
    for (const int element : awaited) {
      attempts_.try_emplace(element, Attempt{.mesh = node_mesh_[element]});
    }
    MORTISE_ASSIGN_OR_RETURN(const bool is_settled, Settle());
    if (!is_settled || !Measure()) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(Tell());
  }
}

// Whether all elements have a mesh, or have failed. First, all at once try what they have
// inherited; then, one after another, others, so that they find those of the ones before them.
absl::StatusOr<bool> StructureShapes::Settle() {
  bool waits = false;
  for (auto& [element, attempt] : attempts_) {
    if (attempt.state != Attempt::State::kTrying || !attempt.tried.empty()) continue;
    if (attempt.mesh < 0) continue;
    MORTISE_ASSIGN_OR_RETURN(const Outcome outcome, Try(element, attempt));
    if (outcome == Outcome::kFits) Accept(element, attempt);
    waits = waits || outcome == Outcome::kWaits;
  }
  if (waits) return false;
  for (auto& [element, attempt] : attempts_) {
    if (attempt.state != Attempt::State::kTrying) continue;
    MORTISE_ASSIGN_OR_RETURN(const bool is_done, TryOthers(element, attempt));
    if (!is_done) return false;
  }
  return true;
}

absl::StatusOr<StructureShapes::Outcome> StructureShapes::Try(int element, const Attempt& attempt) {
  const MeshKey key = KeyOf(attempt.mesh);
  MORTISE_ASSIGN_OR_RETURN(const MadeMesh* const made,
                           work_.Mesh(key, mesh_designs_[attempt.mesh]));
  if (made == nullptr) return Outcome::kWaits;
  if (!made->known.status.ok() || (has_fields_ && made->fields != fields_)) return Outcome::kFails;
  // Meshes of others mostly fail at the centre already, if they do.
  const int centre = CentreProbe(element);
  if (!attempt.tried.empty() && mesh_designs_[attempt.mesh] != centre) {
    const KnownShape* const shape = work_.Shape({key, centre});
    if (shape == nullptr) return Outcome::kWaits;
    if (!shape->status.ok()) return Outcome::kFails;
  }
  Outcome outcome = Outcome::kFits;
  for (const int number : PointsOf(element)) {
    const KnownShape* const shape = work_.Shape({key, number});
    if (shape != nullptr && !shape->status.ok()) outcome = Outcome::kFails;
    if (shape == nullptr && outcome == Outcome::kFits) outcome = Outcome::kWaits;
  }
  return outcome;
}

// Whether it has another mesh, or has failed for good.
absl::StatusOr<bool> StructureShapes::TryOthers(int element, Attempt& attempt) {
  do {
    if (attempt.mesh >= 0) {
      MORTISE_ASSIGN_OR_RETURN(const Outcome outcome, Try(element, attempt));
      if (outcome == Outcome::kWaits) return false;
      if (outcome == Outcome::kFits) {
        Accept(element, attempt);
        return true;
      }
      attempt.tried.push_back(attempt.mesh);
    }
    attempt.mesh = NextMesh(element, attempt);
  } while (attempt.mesh >= 0);
  MORTISE_ASSIGN_OR_RETURN(const bool is_tried_out, IsTriedOut(element));
  if (is_tried_out) attempt.state = Attempt::State::kFails;
  return is_tried_out;
}

// The mesh that most elements beside it have and that was not tried, then its own; -1 if there is
// none left.
int StructureShapes::NextMesh(int element, const Attempt& attempt) {
  const auto was_tried = [&attempt](int mesh) {
    return std::ranges::find(attempt.tried, mesh) != attempt.tried.end();
  };
  if (attempt.tried.size() <= kMostBeside) {
    std::map<int, int> counts;
    for (const int beside : sampling_.tree().Neighbours(element)) {
      const int mesh = FittingMesh(beside);
      if (mesh >= 0 && !was_tried(mesh)) ++counts[mesh];
    }
    const auto most = std::ranges::max_element(
        counts, [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != counts.end()) return most->first;
  }
  const int own = MeshOf(CentreProbe(element));
  return was_tried(own) ? -1 : own;
}

// The mesh of an element that is interpolated; -1 where none is known to fit.
int StructureShapes::FittingMesh(int element) const {
  const auto attempt = attempts_.find(element);
  if (attempt != attempts_.end()) {
    return attempt->second.state == Attempt::State::kFits ? attempt->second.mesh : -1;
  }
  const auto settled = settled_.find(element);
  return settled == settled_.end() || sampling_.IsCutOff(element) ? -1 : settled->second->mesh;
}

// Whether it is known of all points of a failed element whether they can be brought into the mesh
// that it has inherited and into its own.
absl::StatusOr<bool> StructureShapes::IsTriedOut(int element) {
  bool is_known = true;
  for (const int mesh : {node_mesh_[element], MeshOf(CentreProbe(element))}) {
    if (mesh < 0) continue;
    MORTISE_ASSIGN_OR_RETURN(const MadeMesh* const made,
                             work_.Mesh(KeyOf(mesh), mesh_designs_[mesh]));
    if (!made->known.status.ok()) continue;
    for (const int number : PointsOf(element)) {
      is_known = work_.Shape({KeyOf(mesh), number}) != nullptr && is_known;
    }
  }
  return is_known;
}

void StructureShapes::Accept(int element, Attempt& attempt) {
  attempt.state = Attempt::State::kFits;
  node_mesh_[element] = attempt.mesh;
  attempt.probes = ProbesIn(element, attempt.mesh);
  if (has_fields_) return;
  fields_ = work_.FindMesh(KeyOf(attempt.mesh)).fields;
  has_fields_ = true;
}

std::vector<StructureShapes::Probe> StructureShapes::ProbesIn(int element, int mesh) const {
  std::vector<Probe> probes;
  for (const int number : sampling_.ProbesOf(element)) {
    const maps::PointWeights weights = sampling_.tree().Weights(sampling_.PositionOf(number));
    Probe probe;
    for (std::size_t k = 0; k < weights.samples.size(); ++k) {
      const double weight = weights.weights[static_cast<Eigen::Index>(k)];
      if (weight != 0)
        probe.samples.push_back({sampling_.PointOfSample(weights.samples[k]), weight});
    }
    probe.key = {{KeyOf(mesh), number}, DigestOf(probe.samples)};
    probes.push_back(std::move(probe));
  }
  return probes;
}

// Whether it is known how far each element is off.
bool StructureShapes::Measure() {
  bool is_known = true;
  for (const auto& [element, attempt] : attempts_) {
    for (const Probe& probe : attempt.probes) {
      is_known = work_.Difference(probe.key, probe.samples) != nullptr && is_known;
    }
  }
  return is_known;
}

// Whether any range grows by what the elements interpolate.
bool StructureShapes::IncludeRanges() {
  bool has_grown = false;
  for (const auto& [element, attempt] : attempts_) {
    if (attempt.state != Attempt::State::kFits) continue;
    for (const int number : PointsOf(element)) {
      const KnownShape& shape = *work_.FindShape({KeyOf(attempt.mesh), number});
      if (ranges_.empty()) ranges_ = shape.ranges;
      for (std::size_t f = 0; f < ranges_.size(); ++f) {
        const double before = ranges_[f].length();
        ranges_[f].Include(shape.ranges[f]);
        has_grown = has_grown || ranges_[f].length() != before;
      }
    }
  }
  return has_grown;
}

absl::Status StructureShapes::Tell() {
  const bool has_grown = IncludeRanges();
  std::erase_if(settled_, [this](const auto& each) {
    return !sampling_.tree().IsElement(each.first) || sampling_.IsCutOff(each.first) ||
           attempts_.contains(each.first);
  });
  // What others are off is less of a range that has grown.
  for (const auto& [element, settled] : settled_) {
    if (has_grown) {
      MORTISE_RETURN_IF_ERROR(sampling_.TellError(element, OutsideErrorOf(*settled)));
    }
  }
  Elements fresh;
  for (const auto& [element, attempt] : attempts_) {
    if (attempt.state != Attempt::State::kFits) continue;
    Settled settled{.mesh = attempt.mesh, .bending = BendingOf(element, attempt.mesh)};
    for (const Probe& probe : attempt.probes) settled.differences.push_back(probe.key);
    fresh[element] = std::make_shared<const Settled>(std::move(settled));
  }
  settled_.merge(fresh);
  complete_ = settled_;
  complete_ranges_ = ranges_;
  // The last one goes on to the next round.
  const auto attempts = std::exchange(attempts_, {});
  for (const auto& [element, attempt] : attempts) {
    const bool fits = attempt.state == Attempt::State::kFits;
    const maps::OutsideError error =
        fits ? OutsideErrorOf(*settled_.at(element))
             : maps::OutsideError{.bending = DividingDirections(element), .failed = true};
    MORTISE_RETURN_IF_ERROR(sampling_.TellError(element, error));
  }
  return absl::OkStatus();
}

// How strongly the shape and each field bend over an element along each direction, from all that is
// known around it in its mesh.
Eigen::MatrixXd StructureShapes::BendingOf(int element, int mesh) const {
  std::set<int> around;
  std::vector<int> elements = sampling_.tree().Neighbours(element);
  elements.push_back(element);
  for (const int near : elements) {
    if (FittingMesh(near) != mesh) continue;
    const std::vector<int> points = PointsOf(near);
    around.insert(points.begin(), points.end());
  }
  const MadeMesh& made = work_.FindMesh(KeyOf(mesh));
  Eigen::MatrixXd places(sampling_.tree().dimension(), around.size()), traits;
  Eigen::Index n = 0;
  for (const int number : around) {
    const std::vector<float>& each = work_.FindShape({KeyOf(mesh), number})->traits;
    if (n == 0) traits.resize(static_cast<Eigen::Index>(each.size()), places.cols());
    places.col(n) = sampling_.PositionOf(number);
    traits.col(n++) =
        Eigen::VectorXf::Map(each.data(), static_cast<Eigen::Index>(each.size())).cast<double>();
  }
  const Eigen::MatrixXd bending =
      maps::BendingOver(sampling_.tree().BoxOf(element), places, traits);
  Eigen::MatrixXd result(places.rows(), static_cast<Eigen::Index>(made.fields.size()) + 1);
  Eigen::Index first = 0;
  const auto add = [&](Eigen::Index quantity, Eigen::Index count) {
    result.col(quantity) = count == 0
                               ? Eigen::VectorXd(Eigen::VectorXd::Zero(result.rows()))
                               : Eigen::VectorXd(bending.middleCols(first, count).rowwise().norm() /
                                                 std::sqrt(static_cast<double>(count)));
    first += count;
  };
  add(0, 3 * made.trait_nodes);
  for (std::size_t f = 0; f < made.fields.size(); ++f) {
    const bool of_nodes = made.fields[f].place == fields::FieldPlace::kNodes;
    add(static_cast<Eigen::Index>(f) + 1,
        made.fields[f].components * (of_nodes ? made.trait_nodes : made.trait_elements));
  }
  return result;
}

// What errors of the shape and of each field are divided by.
Eigen::VectorXd StructureShapes::ScalesOf(const Settled& settled) const {
  Eigen::VectorXd scales = Eigen::VectorXd::Zero(settled.bending.cols());
  for (const DifferenceKey& key : settled.differences) {
    scales[0] = std::max(scales[0], work_.FindDifference(key).size);
  }
  for (std::size_t f = 0; f < ranges_.size(); ++f) {
    scales[static_cast<Eigen::Index>(f) + 1] = ranges_[f].length();
  }
  return scales;
}

// Of the shape, or of a field, over what its errors are divided by: as given, or as estimated.
double StructureShapes::NoiseFloorOf(Eigen::Index quantity, double scale) const {
  if (quantity == 0) return noise_.shape ? *noise_.shape / scale : options_.noise_floor;
  const FieldKind& field = fields_[static_cast<std::size_t>(quantity) - 1];
  if (const auto floor = noise_.OfFieldNamed(field.name, field.load_case)) return *floor / scale;
  const auto wanted = std::ranges::find_if(
      options_.fields, [&](const WantedField& each) { return each.name == field.name; });
  return wanted == options_.fields.end() ? options_.noise_floor : wanted->noise_floor;
}

maps::OutsideError StructureShapes::OutsideErrorOf(const Settled& settled) const {
  const Eigen::VectorXd scales = ScalesOf(settled);
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(scales.size());
  for (const DifferenceKey& key : settled.differences) {
    const KnownDifference& difference = work_.FindDifference(key);
    errors[0] = std::max(errors[0], difference.shape.of_99);
    for (std::size_t f = 0; f < difference.fields.size(); ++f) {
      double& error = errors[static_cast<Eigen::Index>(f) + 1];
      error = std::max(error, difference.fields[f].of_99);
    }
  }
  maps::OutsideError result{.bending = Eigen::VectorXd::Zero(settled.bending.rows())};
  Eigen::VectorXd all = result.bending;
  for (Eigen::Index q = 0; q < errors.size(); ++q) {
    if (scales[q] <= 0) continue;
    const Eigen::VectorXd along = settled.bending.col(q) / scales[q];
    const double beyond = errors[q] / scales[q] - NoiseFloorOf(q, scales[q]);
    all = all.cwiseMax(along);
    if (beyond <= 0) continue;
    result.error = std::max(result.error, beyond);
    result.bending = result.bending.cwiseMax(along);
  }
  if (result.error == 0) result.bending = all;
  return result;
}

// Along which directions corners of an element differ in whether they can be brought into a mesh:
// the share of its edges that do.
Eigen::VectorXd StructureShapes::DividingDirections(int element) {
  const maps::RefinementTree& tree = sampling_.tree();
  const maps::ElementBox box = tree.BoxOf(element);
  const int dimension = tree.dimension();
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(dimension);
  for (const int mesh : {node_mesh_[element], MeshOf(CentreProbe(element))}) {
    if (mesh < 0 || !work_.FindMesh(KeyOf(mesh)).known.status.ok()) continue;
    std::vector<std::uint8_t> fits(std::size_t{1} << dimension);
    for (const int sample : tree.ElementSamples(element)) {
      const Eigen::VectorXd position = tree.SamplePosition(sample);
      std::size_t corner = 0;
      bool is_corner = true;
      for (int d = 0; d < dimension; ++d) {
        is_corner = is_corner && (position[d] == box.low[d] || position[d] == box.high[d]);
        if (position[d] == box.high[d]) corner |= std::size_t{1} << d;
      }
      if (!is_corner) continue;
      fits[corner] = work_.FindShape({KeyOf(mesh), sampling_.PointOfSample(sample)})->status.ok();
    }
    for (std::size_t corner = 0; corner < fits.size(); ++corner) {
      for (int d = 0; d < dimension; ++d) {
        shares[d] += fits[corner] != fits[corner ^ std::size_t{1} << d] ? 1 : 0;
      }
    }
  }
  return shares / static_cast<double>(std::size_t{1} << dimension);
}

}  // namespace mortise::interpolator
