#include "services/retrieval/service/index_operation.h"

#include <google/protobuf/util/message_differencer.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "common/store/blob_folder.h"
#include "services/retrieval/cover/interpolated_cover.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/families/family_cover.h"
#include "services/retrieval/families/family_manifold.h"
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/service/index_records.h"
#include "services/retrieval/service/template_names.h"

namespace mortise::retrieval {
namespace {

constexpr absl::Duration kCatalogTimeout = absl::Minutes(2);
constexpr std::chrono::milliseconds kLookForTurn{200};
constexpr char kCoverVersion[] = "cover 2";  // changes with what is made of the same template

// Says of a family what is known of its template without making designs; `compiled` is null where
// the template cannot be compiled.
void Describe(const v1::Template& head, const CompiledTemplate* compiled,
              v1::ShapeIndex::Family* family) {
  family->set_template_revision(head.revision());
  resources::CopyTags(head, family);
  family->set_creator(head.creator());
  *family->mutable_create_time() = head.create_time();
  family->set_title(compiled ? compiled->title : head.title());
  family->clear_parameters();
  family->clear_items();
  family->clear_materials();
  if (!compiled) return;
  const templates::TemplateHead& made = compiled->function->head();
  for (const parametric::Parameter& each : made.parameters) family->add_parameters(each.name);
  for (const parametric::Item& each : made.items) family->add_items(each.name);
  for (const parametric::Material& each : made.materials) family->add_materials(each.name);
}

// One build of one index.
class IndexBuild {
 public:
  IndexBuild(const IndexBuilding& building, jobs::OperationContext& context,
             std::shared_ptr<const Descriptor> descriptor, v1::ShapeDescriptor kind, double delta,
             const v1::BuildIndexRequest& request)
      : building_(building),
        context_(context),
        descriptor_(std::move(descriptor)),
        kind_(kind),
        id_(IndexIdOf(kind)),
        delta_(delta),
        request_(request) {
    if (!request.templates().empty()) {
      wanted_.emplace(request.templates().begin(), request.templates().end());
    }
  }

  absl::StatusOr<v1::ShapeIndex> Run(const std::vector<v1::Template>& templates) {
    MORTISE_RETURN_IF_ERROR(ForgetOthers(templates));
    MORTISE_RETURN_IF_ERROR(CoverAll(templates));
    return PutTogether(templates);
  }

 private:
  // Covers of templates that there are no more. Of what is only refreshed, the rest is what is
  // covered; covers of an earlier version are brought up in any case.
  absl::Status ForgetOthers(const std::vector<v1::Template>& templates) {
    std::set<std::string> names;
    for (const v1::Template& each : templates) names.insert(each.name());
    std::set<std::string> outdated;
    MORTISE_RETURN_IF_ERROR(context_.Transact([&](store::Transaction& transaction) -> absl::Status {
      outdated.clear();
      MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> covers,
                               ListCovers(transaction, id_));
      for (const v1::ShapeIndex& cover : covers) {
        const std::string& name = cover.families(0).template_();
        if (names.contains(name)) {
          const bool is_outdated =
              cover.format_version() != kIndexFormat && cover.delta() == delta_;
          if (is_outdated) outdated.insert(name);
        } else {
          MORTISE_RETURN_IF_ERROR(DeleteCover(transaction, id_, name, cover.families(0).group()));
        }
      }
      return absl::OkStatus();
    }));
    if (request_.refresh()) {
      MORTISE_ASSIGN_OR_RETURN(wanted_, InIndex());
    }
    if (wanted_) wanted_->merge(outdated);
    return absl::OkStatus();
  }

  // The templates that the index has now.
  absl::StatusOr<std::set<std::string>> InIndex() const {
    std::set<std::string> names;
    const absl::StatusOr<v1::ShapeIndex> present =
        kIndexes.Get(*building_.environment.store, absl::StrCat(kIndexes.names, "/", id_));
    if (absl::IsNotFound(present.status())) return names;
    MORTISE_RETURN_IF_ERROR(present.status());
    for (const v1::ShapeIndex::Family& each : present->families()) names.insert(each.template_());
    return names;
  }

  absl::Status CoverAll(const std::vector<v1::Template>& templates) {
    const int count = static_cast<int>(templates.size());
    std::mutex mutex;
    int done = 0;
    absl::Status failed;
    const auto cover = [&](int i) {
      if (context_.Cancelled()) return;
      const absl::Status covered = CoverOne(templates[static_cast<std::size_t>(i)]);
      const std::lock_guard lock(mutex);
      if (failed.ok()) failed = covered;
      context_.ReportProgress(
          {.done = ++done, .total = count, .message = absl::StrCat("covering templates by ", id_)});
    };
    ParallelFor(count, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())), cover);
    if (context_.Cancelled()) return absl::CancelledError("the build was cancelled");
    return failed;
  }

  // Fails only where the whole build must: what is wrong with the template is in its cover.
  absl::Status CoverOne(const v1::Template& head) {
    if (wanted_ && !wanted_->contains(head.name())) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(CoverGroup(head, "").status());
    const auto whole = building_.templates.Get(head.name(), head.revision(), Origin());
    if (absl::IsNotFound(whole.status())) return absl::OkStatus();  // removed meanwhile
    std::set<std::string> covered;
    for (const std::string& group : whole.ok() ? GroupsOf(**whole) : std::vector<std::string>{}) {
      if (context_.Cancelled()) return absl::OkStatus();
      MORTISE_ASSIGN_OR_RETURN(const bool is_covered, CoverGroup(head, group));
      if (is_covered) covered.insert(group);
    }
    return ForgetOtherGroups(head.name(), covered);
  }

  // Covers of groups that the template has no more.
  absl::Status ForgetOtherGroups(const std::string& name, const std::set<std::string>& groups) {
    const auto list = [&](store::ReadTransaction& transaction) {
      return ListGroupCovers(transaction, id_, name);
    };
    MORTISE_ASSIGN_OR_RETURN(
        const std::vector<v1::ShapeIndex> covers,
        resources::ReadFrom<std::vector<v1::ShapeIndex>>(*building_.environment.store, list));
    std::vector<std::string> gone;
    for (const v1::ShapeIndex& cover : covers) {
      const std::string& group = cover.families(0).group();
      if (!groups.contains(group)) gone.push_back(group);
    }
    if (gone.empty()) return absl::OkStatus();
    return context_.Transact([&](store::Transaction& transaction) -> absl::Status {
      for (const std::string& group : gone) {
        MORTISE_RETURN_IF_ERROR(DeleteCover(transaction, id_, name, group));
      }
      return absl::OkStatus();
    });
  }

  // Covers the whole, or the sub-tree below a group of it. Returns whether there is such a thing:
  // not every sub-tree holds together by itself.
  absl::StatusOr<bool> CoverGroup(const v1::Template& head, const std::string& group) {
    const absl::StatusOr<std::shared_ptr<const CompiledTemplate>> compiled =
        building_.templates.Get(head.name(), head.revision(), Origin(), group);
    if (absl::IsNotFound(compiled.status())) return false;  // removed meanwhile
    // Only what is wrong with the template itself is told in its cover.
    if (IsPassingFailure(compiled.status())) return compiled.status();
    if (!compiled.ok() && !group.empty()) {
      Log(LogLevel::kInfo, "a sub-tree is no template by itself",
          {{"template", head.name()}, {"group", group}, {"error", compiled.status().message()}});
      return false;
    }
    v1::ShapeIndex cover;
    v1::ShapeIndex::Family& family = *cover.add_families();
    family.set_template_(head.name());
    family.set_group(group);
    family.set_digest(DigestOf(compiled.ok() ? (*compiled)->digest : head.digest()));
    MORTISE_ASSIGN_OR_RETURN(std::optional<v1::ShapeIndex> known, FindKnown(family));
    const CompiledTemplate* const made_of = compiled.ok() ? compiled->get() : nullptr;
    if (known) {
      MORTISE_RETURN_IF_ERROR(BringUp(*std::move(known), head, made_of));
      return true;
    }
    Describe(head, made_of, &family);
    std::vector<Primitive> primitives;
    const absl::Status made =
        compiled.ok() ? MakeCover(**compiled, &family, &primitives) : compiled.status();
    if (context_.Cancelled()) return true;
    if (!made.ok()) {
      family.set_fault(std::string(made.message()));
      Log(LogLevel::kWarning, "a template cannot be searched",
          {{"template", head.name()}, {"index", id_}, {"error", made.message()}});
    }
    MORTISE_RETURN_IF_ERROR(Store(std::move(cover), std::move(primitives)));
    return true;
  }

  rpc::Origin Origin() const {
    return rpc::OwnOrigin(building_.environment.signer, rpc::Role::kViewer, CurrentTraceId(),
                          kCatalogTimeout);
  }

  std::string DigestOf(const std::string& content) const {
    return Sha256Hex(absl::StrFormat("%s %s %d %a %s", kCoverVersion, id_,
                                     descriptor_->properties().dimension, delta_, content));
  }

  // The cover that the template has already, if its file is as it was written.
  absl::StatusOr<std::optional<v1::ShapeIndex>> FindKnown(
      const v1::ShapeIndex::Family& family) const {
    if (request_.anew()) return std::nullopt;
    MORTISE_ASSIGN_OR_RETURN(
        std::optional<v1::ShapeIndex> known,
        resources::ReadFrom<std::optional<v1::ShapeIndex>>(
            *building_.environment.store, [&](store::ReadTransaction& transaction) {
              return FindCover(transaction, id_, family.template_(), family.group());
            }));
    const bool is_usable = known && known->families(0).digest() == family.digest() &&
                           known->families(0).fault().empty() && ReadCover(*known).ok();
    if (!is_usable) known.reset();
    return known;
  }

  // Of a revision with the same designs, what is said about the template may be new.
  absl::Status BringUp(v1::ShapeIndex known, const v1::Template& head,
                       const CompiledTemplate* compiled) {
    const v1::ShapeIndex before = known;
    Describe(head, compiled, known.mutable_families(0));
    known.set_format_version(kIndexFormat);
    if (google::protobuf::util::MessageDifferencer::Equals(before, known)) return absl::OkStatus();
    return context_.Transact(
        [&](store::Transaction& transaction) { return PutCover(transaction, id_, known); });
  }

  absl::Status MakeCover(const CompiledTemplate& compiled, v1::ShapeIndex::Family* family,
                         std::vector<Primitive>* primitives) const {
    MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<Manifold> manifold,
                             MakeFamilyManifold(compiled.function, descriptor_));
    CoverOptions options = FamilyCoverOptions(delta_, *compiled.function);
    options.stop = context_.stop_token();
    MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverByInterpolation(*manifold, options));
    std::set<int> structures;
    for (const Primitive& primitive : cover.primitives) {
      structures.insert(primitive.structure);
      const bool is_point = primitive.axes.cols() == 0;
      is_point ? family->set_points(family->points() + 1)
               : family->set_tangents(family->tangents() + 1);
    }
    family->set_structures(static_cast<int>(structures.size()));
    family->set_evaluations(cover.evaluations);
    family->set_failed_evaluations(cover.failures);
    family->set_truncated(cover.end != CoverEnd::kCovered);
    *primitives = std::move(cover.primitives);
    if (!primitives->empty()) return absl::OkStatus();
    return absl::FailedPreconditionError("none of its designs can be made");
  }

  absl::Status Store(v1::ShapeIndex cover, std::vector<Primitive> primitives) {
    if (!primitives.empty()) {
      std::vector<FamilyCover> alone;
      alone.push_back({.family = 0, .primitives = std::move(primitives)});
      MORTISE_ASSIGN_OR_RETURN(*cover.mutable_sha256(), Keep(std::move(alone)));
    }
    cover.set_name(absl::StrCat(kIndexes.names, "/", id_));
    cover.set_format_version(kIndexFormat);
    cover.set_shape_descriptor(kind_);
    cover.set_delta(delta_);
    return context_.Transact(
        [&](store::Transaction& transaction) { return PutCover(transaction, id_, cover); });
  }

  // The digest of an index of these covers, whose file is stored. One that was damaged since it was
  // stored is written again.
  absl::StatusOr<std::string> Keep(std::vector<FamilyCover> covers) {
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex index, PrimitiveIndex::Build(std::move(covers)));
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, IndexBytes(index, id_, kCoverVersion));
    const std::string digest = Sha256Hex(bytes);
    const absl::Status present = building_.blobs->Get(digest).status();
    if (absl::IsDataLoss(present)) MORTISE_RETURN_IF_ERROR(building_.blobs->Remove(digest));
    return building_.blobs->Put(bytes);
  }

  // The index of all covers: a family's number in it is its place in the record.
  absl::StatusOr<v1::ShapeIndex> PutTogether(const std::vector<v1::Template>& templates) {
    MORTISE_ASSIGN_OR_RETURN(
        const std::vector<v1::ShapeIndex> covers,
        resources::ReadFrom<std::vector<v1::ShapeIndex>>(
            *building_.environment.store,
            [&](store::ReadTransaction& transaction) { return ListCovers(transaction, id_); }));
    v1::ShapeIndex index;
    index.set_name(absl::StrCat(kIndexes.names, "/", id_));
    index.set_shape_descriptor(kind_);
    index.set_delta(delta_);
    index.set_format_version(kIndexFormat);
    std::map<std::string, std::int64_t> covered;
    std::vector<FamilyCover> families;
    for (const v1::ShapeIndex& cover : covers) {
      // Distances of another δ say other things.
      if (cover.delta() != delta_) continue;
      const int number = index.families_size();
      *index.add_families() = cover.families(0);
      covered[cover.families(0).template_()] = cover.families(0).template_revision();
      if (cover.sha256().empty()) continue;
      MORTISE_ASSIGN_OR_RETURN(FamilyCover family, ReadCover(cover));
      family.family = number;
      families.push_back(std::move(family));
    }
    index.set_family_count(static_cast<int>(families.size()));
    MORTISE_ASSIGN_OR_RETURN(const bool every_template, CoversEveryTemplate());
    index.set_every_template(every_template);
    index.set_current(
        std::all_of(templates.begin(), templates.end(), [&](const v1::Template& each) {
          const auto found = covered.find(each.name());
          return found == covered.end() ? !every_template : found->second == each.revision();
        }));
    if (!families.empty()) {
      MORTISE_ASSIGN_OR_RETURN(*index.mutable_sha256(), Keep(std::move(families)));
    }
    MORTISE_RETURN_IF_ERROR(context_.Transact([&](store::Transaction& transaction) {
      *index.mutable_build_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
          absl::ToUnixMicros(transaction.Now()));
      return PutIndex(transaction, index, CurrentTraceId());
    }));
    return index;
  }

  // An index that was once built of all goes on being of all.
  absl::StatusOr<bool> CoversEveryTemplate() const {
    if (!wanted_) return true;
    const absl::StatusOr<v1::ShapeIndex> present =
        kIndexes.Get(*building_.environment.store, absl::StrCat(kIndexes.names, "/", id_));
    if (absl::IsNotFound(present.status())) return false;
    MORTISE_RETURN_IF_ERROR(present.status());
    return present->every_template();
  }

  absl::StatusOr<FamilyCover> ReadCover(const v1::ShapeIndex& cover) const {
    MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path,
                             building_.blobs->PathOf(cover.sha256()));
    MORTISE_ASSIGN_OR_RETURN(const StoredIndex alone, ReadIndex(path, id_));
    FamilyCover family;
    family.primitives.resize(static_cast<std::size_t>(alone.index.primitives()));
    for (int i = 0; i < alone.index.primitives(); ++i) {
      // The index has them in an order of its own.
      const auto number = static_cast<std::size_t>(
          alone.index.arrays().primitives[static_cast<std::size_t>(i)].number);
      if (number >= family.primitives.size()) {
        return absl::DataLossError("a cover has other primitives than it says");
      }
      IndexMatch match;
      match.entry = i;
      family.primitives[number] = alone.index.PrimitiveOf(match);
    }
    return family;
  }

  const IndexBuilding& building_;
  jobs::OperationContext& context_;
  const std::shared_ptr<const Descriptor> descriptor_;
  const v1::ShapeDescriptor kind_;
  const std::string id_;
  const double delta_;
  const v1::BuildIndexRequest& request_;
  std::optional<std::set<std::string>> wanted_;  // templates that are covered; all without
};

// What the request says, or what the index has, or the default.
absl::StatusOr<double> DeltaOf(const v1::BuildIndexRequest& request, const Descriptor& descriptor,
                               store::Store& store) {
  if (request.delta() > 0) return request.delta();
  const absl::StatusOr<v1::ShapeIndex> present =
      kIndexes.Get(store, absl::StrCat(kIndexes.names, "/", descriptor.properties().name));
  if (present.ok()) return present->delta();
  if (absl::IsNotFound(present.status())) return DefaultDelta(descriptor);
  return present.status();
}

std::vector<v1::ShapeDescriptor> DescriptorsOf(const v1::BuildIndexRequest& request) {
  std::set<v1::ShapeDescriptor> chosen;
  for (const int each : request.shape_descriptors()) {
    const auto descriptor = static_cast<v1::ShapeDescriptor>(each);
    chosen.insert(descriptor == v1::SHAPE_DESCRIPTOR_UNSPECIFIED ? v1::D2 : descriptor);
  }
  if (chosen.empty()) return AllShapeDescriptors();
  return {chosen.begin(), chosen.end()};
}

}  // namespace

absl::Status CheckRequest(const v1::BuildIndexRequest& request) {
  absl::Status status;
  const int descriptors = static_cast<int>(AllShapeDescriptors().size());
  if (request.shape_descriptors_size() > descriptors) {
    status = InvalidField("shape_descriptors", absl::StrCat("has more than ", descriptors));
  }
  status = CombineViolations(status, CheckTemplateNames(request.templates()));
  if (request.refresh() && !request.templates().empty()) {
    status = CombineViolations(status, InvalidField("refresh", "is not possible with templates"));
  }
  if (request.delta() == 0) return status;
  if (!(request.delta() > 0)) {
    status =
        CombineViolations(status, InvalidField("delta", "must be above 0, or 0 for a default"));
  }
  if (DescriptorsOf(request).size() == 1) return status;
  return CombineViolations(status, InvalidField("delta", "is of one descriptor: name it"));
}

absl::StatusOr<std::string> RunIndexOperation(const IndexBuilding& building,
                                              jobs::OperationContext& context) {
  v1::BuildIndexRequest request;
  if (!request.ParseFromString(context.request())) {
    return StorageFailed(context.name(), "the request is not readable");
  }
  std::unique_lock turn(building.turn, std::defer_lock);
  while (!turn.try_lock_for(kLookForTurn)) {
    if (context.Cancelled()) return absl::CancelledError("the build was cancelled");
  }
  rpc::RetryOptions retry;
  retry.patience = kCatalogTimeout;  // the catalog may be starting again
  retry.stop = context.stop_token();
  context.ReportProgress({.total = 0, .message = "asking for the templates"});
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<v1::Template> templates,
      building.templates.List({},
                              rpc::OwnOrigin(building.environment.signer, rpc::Role::kViewer,
                                             CurrentTraceId(), kCatalogTimeout),
                              retry));
  for (const std::string& name : request.templates()) {
    const bool is_there =
        std::any_of(templates.begin(), templates.end(),
                    [&](const v1::Template& each) { return each.name() == name; });
    if (!is_there) return ResourceNotFound(name);
  }
  v1::BuildIndexResponse response;
  for (const v1::ShapeDescriptor kind : DescriptorsOf(request)) {
    MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const Descriptor> descriptor,
                             MakeDescriptor(IndexIdOf(kind)));
    MORTISE_ASSIGN_OR_RETURN(const double delta,
                             DeltaOf(request, *descriptor, *building.environment.store));
    IndexBuild build(building, context, descriptor, kind, delta, request);
    MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex index, build.Run(templates));
    index.clear_families();
    *response.add_indexes() = std::move(index);
  }
  return rpc::PackResult(response);
}

}  // namespace mortise::retrieval
