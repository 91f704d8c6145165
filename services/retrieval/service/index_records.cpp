#include "services/retrieval/service/index_records.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/store/blob_folder.h"
#include "services/retrieval/index/index_file.h"

namespace mortise::retrieval {
namespace {

constexpr char kCovers[] = "covers";
constexpr int kAtOnce = 200;

// A template's name has been checked: "templates/table" in the index "d2" is "d2/table", and the
// group "top" of its assembly "d2/table/top".
std::string KeyOf(const std::string& index, const std::string& template_name,
                  const std::string& group) {
  return absl::StrCat(index, "/", template_name.substr(template_name.find('/') + 1),
                      group.empty() ? "" : "/", group);
}

// The covers whose keys begin so.
absl::StatusOr<std::vector<v1::ShapeIndex>> ListBelow(store::ReadTransaction& transaction,
                                                      const std::string& prefix) {
  std::vector<v1::ShapeIndex> covers;
  store::ListOptions options{.key_prefix = prefix, .limit = kAtOnce};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(kCovers, options));
    for (const store::Record& record : records) {
      MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex cover,
                               resources::ParseRecord<v1::ShapeIndex>(kCovers, record));
      covers.push_back(std::move(cover));
    }
    if (static_cast<int>(records.size()) < kAtOnce) break;
    options.after_key = records.back().key;
  }
  // Keys have "table-large" before the groups of "table".
  std::ranges::stable_sort(covers, {}, [](const v1::ShapeIndex& cover) {
    return std::pair(cover.families(0).template_(), cover.families(0).group());
  });
  return covers;
}

}  // namespace

std::string IndexIdOf(v1::ShapeDescriptor descriptor) {
  switch (descriptor) {
    case v1::VOXEL:
      return "voxel";
    case v1::LIGHT_FIELD:
      return "light-field";
    default:
      return "d2";
  }
}

std::vector<v1::ShapeDescriptor> AllShapeDescriptors() {
  return {v1::D2, v1::VOXEL, v1::LIGHT_FIELD};
}

bool IsOfThisVersion(const v1::ShapeIndex& record, const Descriptor& descriptor) {
  return record.format_version() == kIndexFormat &&
         record.descriptor_version() == descriptor.properties().version;
}

v1::ShapeIndex EmptyCover(v1::ShapeDescriptor kind, double delta, const Descriptor& descriptor,
                          const v1::ShapeIndex::Family& family) {
  v1::ShapeIndex cover;
  cover.set_name(absl::StrCat(kIndexes.names, "/", IndexIdOf(kind)));
  cover.set_shape_descriptor(kind);
  cover.set_delta(delta);
  cover.set_format_version(kIndexFormat);
  cover.set_descriptor_version(descriptor.properties().version);
  *cover.add_families() = family;
  return cover;
}

absl::StatusOr<std::optional<v1::ShapeIndex>> FindCover(store::ReadTransaction& transaction,
                                                        const std::string& index,
                                                        const std::string& template_name,
                                                        const std::string& group) {
  const absl::StatusOr<store::Record> record =
      transaction.Get(kCovers, KeyOf(index, template_name, group));
  if (absl::IsNotFound(record.status())) return std::nullopt;
  MORTISE_RETURN_IF_ERROR(record.status());
  MORTISE_ASSIGN_OR_RETURN(v1::ShapeIndex cover,
                           resources::ParseRecord<v1::ShapeIndex>(kCovers, *record));
  return cover;
}

absl::StatusOr<std::vector<v1::ShapeIndex>> ListCovers(store::ReadTransaction& transaction,
                                                       const std::string& index) {
  return ListBelow(transaction, index + "/");
}

absl::StatusOr<std::vector<v1::ShapeIndex>> ListGroupCovers(store::ReadTransaction& transaction,
                                                            const std::string& index,
                                                            const std::string& template_name) {
  return ListBelow(transaction, KeyOf(index, template_name, "") + "/");
}

absl::Status PutCover(store::Transaction& transaction, const std::string& index,
                      const v1::ShapeIndex& cover) {
  return transaction
      .Put(kCovers, KeyOf(index, cover.families(0).template_(), cover.families(0).group()),
           cover.SerializeAsString())
      .status();
}

absl::Status DeleteCover(store::Transaction& transaction, const std::string& index,
                         const std::string& template_name, const std::string& group) {
  return transaction.Delete(kCovers, KeyOf(index, template_name, group));
}

absl::Status ForgetIndex(store::Transaction& transaction, const std::string& name,
                         const std::string& trace_id) {
  MORTISE_RETURN_IF_ERROR(kIndexes.Get(transaction, name).status());
  MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, kIndexes.names, "name"));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> covers, ListCovers(transaction, id));
  for (const v1::ShapeIndex& cover : covers) {
    MORTISE_RETURN_IF_ERROR(
        DeleteCover(transaction, id, cover.families(0).template_(), cover.families(0).group()));
  }
  MORTISE_RETURN_IF_ERROR(transaction.Delete(kIndexes.kind, id));
  return transaction.AppendEvent(
      {.type = "index.deleted", .subject = name, .payload = "{}", .trace_id = trace_id});
}

absl::Status PutIndex(store::Transaction& transaction, const v1::ShapeIndex& index,
                      const std::string& trace_id) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id,
                           ParseResourceName(index.name(), kIndexes.names, "name"));
  MORTISE_RETURN_IF_ERROR(transaction.Put(kIndexes.kind, id, index.SerializeAsString()).status());
  const nlohmann::json data = {{"families", index.family_count()}, {"sha256", index.sha256()}};
  return transaction.AppendEvent({.type = "index.updated",
                                  .subject = index.name(),
                                  .payload = data.dump(),
                                  .trace_id = trace_id});
}

absl::StatusOr<std::string> StoreCoverFile(store::BlobFolder& blobs, std::string_view bytes) {
  const std::string digest = Sha256Hex(bytes);
  const absl::Status present = blobs.Get(digest).status();
  if (absl::IsDataLoss(present)) MORTISE_RETURN_IF_ERROR(blobs.Remove(digest));
  return blobs.Put(bytes);
}

absl::StatusOr<FamilyCover> ReadCover(store::BlobFolder& blobs, const std::string& sha256,
                                      const Descriptor& descriptor) {
  MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path, blobs.PathOf(sha256));
  MORTISE_ASSIGN_OR_RETURN(const StoredIndex alone, ReadIndex(path, FormatOf(descriptor)));
  const bool is_cover = alone.index.families() == 1 && alone.index.arrays().families[0] == 0 &&
                        alone.index.dimension() == descriptor.properties().dimension;
  if (!is_cover) return absl::DataLossError("the file is not a cover of one family");
  FamilyCover cover;
  cover.primitives.resize(static_cast<std::size_t>(alone.index.primitives()));
  for (int i = 0; i < alone.index.primitives(); ++i) {
    // The index has them in an order of its own.
    const auto number = static_cast<std::size_t>(
        alone.index.arrays().primitives[static_cast<std::size_t>(i)].number);
    if (number >= cover.primitives.size()) {
      return absl::DataLossError("a cover has other primitives than it says");
    }
    IndexMatch match;
    match.entry = i;
    cover.primitives[number] = alone.index.PrimitiveOf(match);
  }
  return cover;
}

void CountPrimitives(const FamilyCover& cover, v1::ShapeIndex::Family* family) {
  std::set<int> structures;
  int points = 0;
  for (const Primitive& primitive : cover.primitives) {
    structures.insert(primitive.structure);
    if (primitive.axes.cols() == 0) ++points;
  }
  family->set_structures(static_cast<int>(structures.size()));
  family->set_points(points);
  family->set_tangents(static_cast<int>(cover.primitives.size()) - points);
}

}  // namespace mortise::retrieval
