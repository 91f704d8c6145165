#include "services/interpolator/building/shape_work.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/mapping/guarded.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/shape_file.h"

namespace mortise::interpolator {
namespace {

// Kinds of work, before their keys.
constexpr int kMesh = 0, kShape = 1, kDifference = 2;

MadeMesh Described(KnownMesh known, const ReadyMesh& ready) {
  const CanonicalMesh& mesh = ready.mesh();
  MadeMesh made;
  made.known = std::move(known);
  made.fields = mesh.fields;
  for (const fields::Region& region : mesh.regions) made.regions.push_back(region.name);
  made.nodes = mesh.node_count();
  made.triangles = mesh.triangles.cols();
  made.tetrahedra = mesh.element_count();
  made.trait_nodes = static_cast<std::int64_t>(ready.traits.nodes.size());
  made.trait_elements = static_cast<std::int64_t>(ready.traits.elements.size());
  return made;
}

// Whether a design itself is why it has no mesh or is in none, and not the machine or the moment:
// its topology, its file, or numbers that nothing can be computed with.
bool IsOfDesign(const absl::Status& status) {
  return absl::IsFailedPrecondition(status) || absl::IsInvalidArgument(status) ||
         absl::IsInternal(status);
}

double SizeOf(const Eigen::Matrix3Xd& nodes) {
  return (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
}

}  // namespace

ShapeWork::ShapeWork(const ShapeOptions& options, std::function<void(Event)> post)
    : options_(options),
      post_(std::move(post)),
      store_(options),
      threads_(std::max(1, options.threads)) {}

void ShapeWork::AddDesign(int structure, std::int64_t number, const std::string& digest) {
  files_[{structure, number}] = digest;
}

absl::Status ShapeWork::CheckDesign(const std::string& digest, absl::Status& fault) {
  const auto design = store_.Design(digest);
  if (!design.ok()) {
    if (DetailOf(design.status()).reason != "SHAPE_UNREADABLE") return design.status();
    fault = design.status();
    return absl::OkStatus();
  }
  for (const WantedField& wanted : options_.fields) {
    const bool has = std::ranges::any_of(
        (*design)->fields, [&](const fields::Field& field) { return field.name == wanted.name; });
    if (has) continue;
    fault = WithDetail(
        absl::InternalError(absl::StrCat("the evaluator left out the field '", wanted.name, "'")),
        {"FIELD_MISSING", ""});
  }
  return absl::OkStatus();
}

// `work` runs on a thread and says what is to happen with what it has found out. What is not known
// yet waits while it is held.
void ShapeWork::Submit(const Name& name, bool is_known, std::function<Event()> work) {
  if (is_stopped_ || !under_way_.insert(name).second) return;
  if (name.first == kShape) ++to_map_;
  std::function<void()> task = [this, name, work = std::move(work)] {
    Event event;
    if (!is_stopped_) {
      const absl::Status status = Guarded([&work, &event] {
        event = work();
        return absl::OkStatus();
      });
      if (!status.ok()) event = [status] { return status; };
    }
    post_([this, name, event = std::move(event)] {
      under_way_.erase(name);
      if (name.first == kShape) --to_map_;
      const absl::Status status = event ? event() : absl::OkStatus();
      // What is got or put may have been interrupted.
      return is_stopped_ ? absl::OkStatus() : status;
    });
  };
  if (is_held_ && !is_known) {
    held_.push_back(std::move(task));
  } else {
    threads_.Submit(std::move(task));
  }
}

void ShapeWork::Release() {
  is_held_ = false;
  for (std::function<void()>& task : held_) threads_.Submit(std::move(task));
  held_.clear();
}

void ShapeWork::Stop() {
  is_stopped_ = true;
  Release();
}

absl::StatusOr<const MadeMesh*> ShapeWork::Mesh(const MeshKey& key, std::int64_t number) {
  const auto made = meshes_.find(key);
  if (made != meshes_.end()) return &made->second;
  KnownMesh known;
  const auto found = known_.meshes.find(key);
  if (found != known_.meshes.end()) {
    known = found->second;
    if (known.number != number) {
      return absl::DataLossError("the canonical meshes that were kept are of another map");
    }
  }
  if (IsUnderWay({kMesh, {{key, 0}, 0}})) return nullptr;
  known.number = number;
  if (!known.status.ok()) {
    CountFailure(known.status);
    MadeMesh& failed = meshes_[key];
    failed.known = known;
    return &failed;
  }
  Submit({kMesh, {{key, 0}, 0}}, !known.digest.empty(),
         [this, key, known, file = FileOf(key.structure, number)] {
           absl::StatusOr<MadeMesh> result = MakeMesh(known, file);
           return Event([this, key, result = std::move(result)]() -> absl::Status {
             MORTISE_RETURN_IF_ERROR(result.status());
             meshes_[key] = *result;
             if (!result->known.status.ok()) CountFailure(result->known.status);
             if (!known_.meshes.contains(key)) fresh_.meshes[key] = result->known;
             known_.meshes[key] = result->known;
             return absl::OkStatus();
           });
         });
  return nullptr;
}

absl::StatusOr<MadeMesh> ShapeWork::MakeMesh(const KnownMesh& known, const std::string& design) {
  MadeMesh made;
  made.known = known;
  if (known.digest.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const auto read, store_.Design(design));
    const absl::StatusOr<CanonicalMesh> mesh =
        Guarded([&read] { return CanonicalMesh::Create(*read); });
    made.known.status = mesh.status();
    if (!mesh.ok() && !IsOfDesign(mesh.status())) return mesh.status();
    if (!mesh.ok()) return made;
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, WriteMesh(*mesh));
    MORTISE_ASSIGN_OR_RETURN(made.known.digest, store_.Put(bytes));
    made.known.bytes = static_cast<std::int64_t>(bytes.size());
  }
  // Of its file, as it will be read again.
  MORTISE_ASSIGN_OR_RETURN(const auto ready, store_.Mesh(made.known.digest));
  return Described(std::move(made.known), *ready);
}

const KnownShape* ShapeWork::FindShape(const ShapeKey& key) const {
  const auto found = known_.shapes.find(key);
  return found == known_.shapes.end() ? nullptr : &found->second;
}

const KnownShape* ShapeWork::Shape(const ShapeKey& key) {
  if (const KnownShape* known = FindShape(key)) {
    Count(key, *known);
    return known;
  }
  if (IsUnderWay({kShape, {key, 0}})) return nullptr;
  Submit({kShape, {key, 0}}, false,
         [this, key, file = FileOf(key.mesh.structure, key.number),
          mesh = meshes_.at(key.mesh).known.digest] {
           absl::StatusOr<KnownShape> result = Bring(file, mesh);
           return Event([this, key, result = std::move(result)]() -> absl::Status {
             MORTISE_RETURN_IF_ERROR(result.status());
             known_.shapes[key] = fresh_.shapes[key] = *result;
             Count(key, *result);
             return absl::OkStatus();
           });
         });
  return nullptr;
}

void ShapeWork::Count(const ShapeKey& key, const KnownShape& shape) {
  if (!counted_.insert(key).second) return;
  if (shape.status.ok()) {
    ++mapped_;
  } else {
    CountFailure(shape.status);
  }
}

void ShapeWork::CountFailure(const absl::Status& status) {
  ++failed_;
  failures_.Add(
      {DetailOf(status).reason, status.code(), std::string(status.message()), Eigen::VectorXd()});
}

absl::StatusOr<KnownShape> ShapeWork::Bring(const std::string& design, const std::string& mesh) {
  MORTISE_ASSIGN_OR_RETURN(const auto read, store_.Design(design));
  MORTISE_ASSIGN_OR_RETURN(const auto ready, store_.Mesh(mesh));
  KnownShape known;
  const absl::StatusOr<BroughtShape> brought =
      Guarded([&ready, &read] { return ready->prepared.Bring(*read); });
  known.status = brought.status();
  if (!brought.ok() && !IsOfDesign(brought.status())) return brought.status();
  if (!brought.ok()) return known;
  const absl::StatusOr<PackedShape> packed = Pack(brought->shape, ready->mesh());
  known.status = packed.status();
  if (!packed.ok()) return known;
  // What is decided by, counted and compared is what is kept and served: rounding may turn over
  // thin elements that mapping has not.
  const ConsistentShape unpacked = Unpack(*packed);
  const int elements = ready->mesh().element_count();
  known.inverted = TurnedOver(ready->mesh(), unpacked.nodes);
  if (known.inverted > options_.most_inverted * elements) {
    known.status = PreconditionFailed(
        "TOO_MANY_INVERTED",
        absl::StrCat(known.inverted, " of ", elements, " tetrahedra would be turned over"));
    return known;
  }
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, WriteShape(*packed, ready->mesh()));
  MORTISE_ASSIGN_OR_RETURN(known.digest, store_.Put(bytes));
  known.bytes = static_cast<std::int64_t>(bytes.size());
  known.rounding = PositionError(*packed);
  known.size = SizeOf(unpacked.nodes);
  known.ranges = RangesOf(*packed);
  known.traits = TraitsOf(unpacked, ready->mesh(), ready->traits);
  return known;
}

const KnownDifference* ShapeWork::Difference(const DifferenceKey& key,
                                             const std::vector<WeightedDesign>& others) {
  const auto found = known_.differences.find(key);
  if (found != known_.differences.end()) return &found->second;
  if (IsUnderWay({kDifference, key})) return nullptr;
  const MeshKey mesh = key.shape.mesh;
  std::vector<std::pair<std::string, double>> weighted;
  for (const WeightedDesign& other : others) {
    weighted.emplace_back(known_.shapes.at({mesh, other.number}).digest, other.weight);
  }
  Submit({kDifference, key}, false,
         [this, key, weighted = std::move(weighted), digest = meshes_.at(mesh).known.digest,
          file = FileOf(mesh.structure, key.shape.number),
          truth = known_.shapes.at(key.shape).digest] {
           absl::StatusOr<KnownDifference> result = Compare(file, digest, truth, weighted);
           return Event([this, key, result = std::move(result)]() -> absl::Status {
             MORTISE_RETURN_IF_ERROR(result.status());
             known_.differences[key] = fresh_.differences[key] = *result;
             return absl::OkStatus();
           });
         });
  return nullptr;
}

absl::StatusOr<KnownDifference> ShapeWork::Compare(
    const std::string& design, const std::string& mesh, const std::string& truth,
    const std::vector<std::pair<std::string, double>>& others) {
  MORTISE_ASSIGN_OR_RETURN(const auto read, store_.Design(design));
  MORTISE_ASSIGN_OR_RETURN(const auto ready, store_.Mesh(mesh));
  MORTISE_ASSIGN_OR_RETURN(const auto true_shape, store_.Shape(truth, ready->mesh()));
  std::vector<std::shared_ptr<const PackedShape>> kept;  // as long as they are blended
  std::vector<WeightedShape> shapes;
  for (const auto& [digest, weight] : others) {
    MORTISE_ASSIGN_OR_RETURN(auto shape, store_.Shape(digest, ready->mesh()));
    kept.push_back(std::move(shape));
    shapes.push_back({kept.back().get(), weight});
  }
  BlendedParts all;
  for (std::size_t f = 0; f < ready->mesh().fields.size(); ++f) {
    all.fields.push_back(static_cast<int>(f));
  }
  BlendedShape blended;
  MORTISE_RETURN_IF_ERROR(Blend(shapes, ready->mesh(), all, blended));
  const ConsistentShape brought = Unpack(*true_shape);
  MORTISE_ASSIGN_OR_RETURN(ShapeDifference difference,
                           interpolator::Difference(blended, ready->mesh(), *read, &brought));
  return KnownDifference{difference.size, difference.shape, std::move(difference.fields)};
}

absl::Status ShapeWork::Keep() {
  if (fresh_.empty()) return absl::OkStatus();
  const KnownShapes kept = std::exchange(fresh_, {});
  return options_.keep ? options_.keep(kept) : absl::OkStatus();
}

}  // namespace mortise::interpolator
