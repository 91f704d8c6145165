#include "services/retrieval/families/family_manifold.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "services/retrieval/cover/differences.h"
#include "services/retrieval/descriptors/descriptor_jacobian.h"
#include "services/retrieval/families/design_surface.h"
#include "services/retrieval/families/parameter_domain.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kScouts = 256;  // designs whose structures are looked up beforehand
constexpr std::size_t kMaxStructures = 64;
constexpr std::uint64_t kScoutSeed = 17;
constexpr double kMinStep = 1e-3;  // of a difference's: with less room there is none

// The designs of one structure, described through one choice of points on a reference.
struct StructureFamily {
  parametric::Structure structure;
  mesh::SurfaceMesh reference;
  std::unique_ptr<BoundDescriptor> bound;
};

// A number for a structure that is the same in every process: 28 bits of its key.
int NumberOf(const parametric::Structure& structure) {
  return static_cast<int>(std::stoul(parametric::KeyOf(structure).substr(0, 7), nullptr, 16));
}

// The structures of designs that were asked for a short while ago: covers ask for a design and
// then, once or twice, for its structure, which takes a part of the time of either.
class RecentStructures {
 public:
  std::optional<int> Find(const VectorXd& q) const {
    const std::lock_guard lock(mutex_);
    const auto found = numbers_.find(KeyOf(q));
    return found == numbers_.end() ? std::nullopt : std::optional(found->second);
  }

  void Add(const VectorXd& q, int number) {
    const std::lock_guard lock(mutex_);
    if (numbers_.size() >= kMost) numbers_.clear();
    numbers_[KeyOf(q)] = number;
  }

 private:
  static constexpr std::size_t kMost = 4096;

  static std::string KeyOf(const VectorXd& q) {
    return {reinterpret_cast<const char*>(q.data()),
            static_cast<std::size_t>(q.size()) * sizeof(double)};
  }

  mutable std::mutex mutex_;
  std::unordered_map<std::string, int> numbers_;  // by the bytes of q; guarded by mutex_
};

// What evaluations share; they come on several threads.
struct Family {
  std::shared_ptr<const templates::Template> design_template;
  std::shared_ptr<const Descriptor> descriptor;
  LinearConstraints constraints;
  std::vector<StructureFamily> structures;   // the default design's first
  std::shared_ptr<DescribedDesigns> shared;  // where it makes the designs
  std::size_t place = 0;                     // of the descriptor there
  mutable RecentStructures recent;
  std::vector<bool> whole;      // which parameters are whole numbers
  bool has_structures = false;  // whether designs may be of several

  const StructureFamily* Find(const parametric::Structure& structure) const {
    for (const StructureFamily& each : structures) {
      if (each.structure == structure) return &each;
    }
    return nullptr;
  }
};

// A design as its surface.
struct SurfaceDesign {
  mesh::SurfaceMesh surface;
  parametric::Structure structure;
};

absl::StatusOr<SurfaceDesign> SurfaceAt(const templates::Template& design_template,
                                        const VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design, design_template.Evaluate(q));
  SurfaceDesign made{DesignSurface(design), {}};
  if (design.structure) made.structure = *std::move(design.structure);
  return made;
}

// Faces may be divided otherwise into as many triangles: what is bound has its own.
bool HasVerticesOf(const StructureFamily& family, const mesh::SurfaceMesh& surface) {
  return surface.vertices.cols() == family.reference.vertices.cols() &&
         surface.triangles.cols() == family.reference.triangles.cols();
}

absl::StatusOr<VectorXd> Describe(const Family& family, const VectorXd& q) {
  if (family.shared != nullptr) {
    const std::shared_ptr<const DescribedDesign> design = family.shared->At(q);
    const absl::StatusOr<VectorXd>& vector = design->vectors[family.place];
    if (vector.ok() && family.has_structures) {
      family.recent.Add(q, NumberOf(design->structure));
    }
    return vector;
  }
  MORTISE_ASSIGN_OR_RETURN(const SurfaceDesign design, SurfaceAt(*family.design_template, q));
  if (family.has_structures) family.recent.Add(q, NumberOf(design.structure));
  const StructureFamily* const known = family.Find(design.structure);
  if (known != nullptr && known->bound && HasVerticesOf(*known, design.surface)) {
    return known->bound->Describe(design.surface.vertices);
  }
  return family.descriptor->Describe(design.surface);
}

// The change of one parameter, from q, with the most room for it, and no longer than `most`.
double StepWithin(const LinearConstraints& constraints, const VectorXd& q, Index k, double most) {
  const VectorXd unit = VectorXd::Unit(q.size(), k);
  const double up = RoomAlong(constraints, q, unit), down = RoomAlong(constraints, q, -unit);
  return up >= down ? std::min(up, most) : -std::min(down, most);
}

// The members along the parameters `moving`, as far as there is room.
SurfaceFamily MembersBeside(const Family& family, const StructureFamily& known, const VectorXd& q,
                            const std::vector<Index>& moving) {
  const auto count = static_cast<Index>(moving.size());
  SurfaceFamily members{.lower = VectorXd(count), .upper = VectorXd(count), .surface = {}};
  for (Index i = 0; i < count; ++i) {
    const Index k = moving[static_cast<std::size_t>(i)];
    const VectorXd unit = VectorXd::Unit(q.size(), k);
    members.lower[i] = q[k] - RoomAlong(family.constraints, q, -unit);
    members.upper[i] = q[k] + RoomAlong(family.constraints, q, unit);
  }
  members.surface = [&](const VectorXd& values) -> absl::StatusOr<mesh::SurfaceMesh> {
    VectorXd at = q;
    at(moving) = values;
    MORTISE_ASSIGN_OR_RETURN(SurfaceDesign design, SurfaceAt(*family.design_template, at));
    if (design.structure == known.structure && HasVerticesOf(known, design.surface)) {
      design.surface.triangles = known.reference.triangles;
    }
    return std::move(design.surface);
  };
  return members;
}

// First derivatives by the descriptor's own and the vertices' velocities; second ones by what one
// design a parameter adds to them: M(q + h) - M(q) - h M'(q) is h² M''(q) / 2.
absl::StatusOr<Derivatives> Differentiate(const Family& family, const VectorXd& extents,
                                          const VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Structure structure,
                           family.design_template->StructureAt(q));
  const StructureFamily* const known = family.Find(structure);
  if (known == nullptr) return absl::FailedPreconditionError("nothing is bound to this structure");
  const VectorXd steps = DifferenceSteps(extents, 0);
  std::vector<Index> moving;
  for (Index k = 0; k < q.size(); ++k) {
    if (family.whole[static_cast<std::size_t>(k)]) continue;
    if (std::abs(StepWithin(family.constraints, q, k, steps[k])) > kMinStep * steps[k]) {
      moving.push_back(k);
    }
  }
  MORTISE_ASSIGN_OR_RETURN(
      const DescriptorDerivatives along,
      DescriptorJacobian(*known->bound, MembersBeside(family, *known, q, moving), q(moving)));
  Derivatives result;
  result.first.setZero(along.value.size(), q.size());
  result.second.setZero(along.value.size(), q.size());
  for (Index i = 0; i < along.jacobian.cols(); ++i) {
    const Index k = moving[static_cast<std::size_t>(i)];
    const double step = StepWithin(family.constraints, q, k, steps[k]);
    MORTISE_ASSIGN_OR_RETURN(const VectorXd beside,
                             Describe(family, q + step * VectorXd::Unit(q.size(), k)));
    result.first.col(k) = along.jacobian.col(i);
    result.second.col(k) =
        2 / (step * step) * (beside - along.value - step * along.jacobian.col(i));
  }
  result.evaluations = 1 + 2 * along.jacobian.cols();
  return result;
}

// 0 where there is no design.
int StructureNumber(const Family& family, const VectorXd& q) {
  if (!family.has_structures) return 0;
  if (const auto known = family.recent.Find(q)) return *known;
  const absl::StatusOr<parametric::Structure> structure = family.design_template->StructureAt(q);
  const int number = structure.ok() ? NumberOf(*structure) : 0;
  family.recent.Add(q, number);
  return number;
}

absl::Status AddStructure(const VectorXd& q, Family* family) {
  MORTISE_ASSIGN_OR_RETURN(SurfaceDesign design, SurfaceAt(*family->design_template, q));
  if (family->Find(design.structure) != nullptr) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<BoundDescriptor> bound,
                           family->descriptor->Bind(design.surface));
  family->structures.push_back(
      {std::move(design.structure), std::move(design.surface), std::move(bound)});
  return absl::OkStatus();
}

// Binds the descriptor to a design of each structure that some samples have.
void AddStructuresOf(const std::vector<VectorXd>& samples, Family* family) {
  if (!family->has_structures) return;
  for (const VectorXd& q : samples) {
    if (family->structures.size() == kMaxStructures) break;
    const auto structure = family->design_template->StructureAt(q);
    if (!structure.ok() || family->Find(*structure) != nullptr) continue;
    // One that cannot be made is no family of designs.
    AddStructure(q, family).IgnoreError();
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<Manifold>> MakeFamilyManifold(
    std::shared_ptr<const templates::Template> design_template,
    std::shared_ptr<const Descriptor> descriptor, std::shared_ptr<DescribedDesigns> shared,
    std::size_t place) {
  MORTISE_ASSIGN_OR_RETURN(ParameterDomain box, DomainOf(*design_template));
  ManifoldFunctions functions;
  functions.lower = std::move(box.lower);
  functions.upper = std::move(box.upper);
  functions.cuts = std::move(box.cuts);
  functions.whole = box.whole;
  auto family = std::make_shared<Family>();
  family->whole = std::move(box.whole);
  family->design_template = std::move(design_template);
  family->descriptor = std::move(descriptor);
  MORTISE_RETURN_IF_ERROR(
      AddStructure(parametric::Defaults(family->design_template->parameters()), family.get()));
  family->has_structures = !family->structures.front().structure.counts.empty() ||
                           family->design_template->MayLeaveOut();

  const DescriptorProperties& properties = family->descriptor->properties();
  functions.dimension = properties.dimension;
  functions.noise = properties.sampling_noise / properties.natural_scale;
  functions.evaluate = [family](const VectorXd& q) { return Describe(*family, q); };
  functions.structure = [family](const VectorXd& q) { return StructureNumber(*family, q); };
  const FunctionManifold domain(functions);
  family->constraints = domain.constraints();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<VectorXd> scouts, domain.Sample(kScouts, kScoutSeed));
  if (family->design_template->MeshesAnew()) {
    family->structures.front().bound.reset();
    family->shared = std::move(shared);
    family->place = place;
  } else {
    AddStructuresOf(scouts, family.get());
    functions.noise = properties.bound_noise / properties.natural_scale;
    if (properties.differentiates_exactly) {
      MORTISE_ASSIGN_OR_RETURN(const VectorXd extents, ExtentsOf(family->constraints));
      functions.derivatives = [family, extents](const VectorXd& q) {
        return Differentiate(*family, extents, q);
      };
    }
  }
  return std::make_unique<FunctionManifold>(std::move(functions));
}

}  // namespace mortise::retrieval
