#include "services/retrieval/service/index_assembly.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/service/cover_making.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

// An index that was once built of all goes on being of all.
absl::StatusOr<bool> CoversEveryTemplate(store::Store& store, const IndexTarget& target) {
  if (!target.wanted) return true;
  const absl::StatusOr<v1::ShapeIndex> present =
      kIndexes.Get(store, absl::StrCat(kIndexes.names, "/", target.id));
  if (absl::IsNotFound(present.status())) return false;
  MORTISE_RETURN_IF_ERROR(present.status());
  return present->every_template();
}

// Whether the templates that it is kept up to are in it as they are.
bool IsCurrent(const v1::ShapeIndex& index, const std::vector<v1::Template>& templates) {
  std::map<std::string, std::int64_t> covered;
  for (const v1::ShapeIndex::Family& family : index.families()) {
    covered[family.template_()] = family.template_revision();
  }
  return std::all_of(templates.begin(), templates.end(), [&](const v1::Template& each) {
    const auto found = covered.find(each.name());
    return found == covered.end() ? !index.every_template() : found->second == each.revision();
  });
}

}  // namespace

absl::StatusOr<v1::ShapeIndex> PutIndexTogether(const IndexBuilding& building,
                                                operations::OperationContext& context,
                                                const IndexTarget& target,
                                                const std::vector<v1::Template>& templates) {
  store::Store& store = *building.environment.store;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> covers,
                           resources::ReadFrom<std::vector<v1::ShapeIndex>>(
                               store, [&](store::ReadTransaction& transaction) {
                                 return ListCovers(transaction, target.id);
                               }));
  v1::ShapeIndex index;
  index.set_name(absl::StrCat(kIndexes.names, "/", target.id));
  index.set_shape_descriptor(target.kind);
  index.set_delta(target.delta);
  index.set_format_version(kIndexFormat);
  index.set_descriptor_version(target.descriptor->properties().version);
  std::vector<FamilyCover> families;
  for (const v1::ShapeIndex& cover : covers) {
    // Distances of another δ, or of another version of the descriptor, say other things.
    if (cover.delta() != target.delta || !IsOfThisVersion(cover, *target.descriptor)) continue;
    const int number = index.families_size();
    *index.add_families() = cover.families(0);
    if (cover.sha256().empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(FamilyCover family,
                             ReadCover(*building.blobs, cover.sha256(), *target.descriptor));
    family.family = number;
    families.push_back(std::move(family));
  }
  index.set_family_count(static_cast<int>(families.size()));
  MORTISE_ASSIGN_OR_RETURN(const bool every_template, CoversEveryTemplate(store, target));
  index.set_every_template(every_template);
  index.set_current(IsCurrent(index, templates));
  if (!families.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const PrimitiveIndex all, PrimitiveIndex::Build(std::move(families)));
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes,
                             IndexBytes(all, FormatOf(*target.descriptor), kCoverVersion));
    MORTISE_ASSIGN_OR_RETURN(*index.mutable_sha256(), StoreCoverFile(*building.blobs, bytes));
  }
  MORTISE_RETURN_IF_ERROR(context.Transact([&](store::Transaction& transaction) {
    *index.mutable_build_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
        absl::ToUnixMicros(transaction.Now()));
    return PutIndex(transaction, index, CurrentTraceId());
  }));
  return index;
}

}  // namespace mortise::retrieval
