#include "services/interpolator/records/map_files.h"

#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr char kKind[] = "mapFiles";
constexpr std::size_t kDigestBytes = 32;
constexpr int kPage = 100;

}  // namespace

absl::Status PutMapFiles(store::Transaction& transaction, const std::string& id,
                         const std::vector<StoredShapes>& shapes) {
  std::set<std::string> digests;
  for (const StoredShapes& of_structure : shapes) {
    for (const StoredMesh& mesh : of_structure.meshes) {
      digests.insert(mesh.file);
      for (const auto& [sample, shape] : mesh.shapes) digests.insert(shape);
    }
  }
  stored::Files files;
  for (const std::string& digest : digests) {
    files.mutable_digests()->append(absl::HexStringToBytes(digest));
  }
  return transaction.Put(kKind, id, files.SerializeAsString()).status();
}

absl::Status DropMapFiles(store::Transaction& transaction, const std::string& id) {
  const absl::Status dropped = transaction.Delete(kKind, id);
  return absl::IsNotFound(dropped) ? absl::OkStatus() : dropped;
}

absl::Status AddMapFiles(store::ReadTransaction& transaction, std::set<std::string>* named) {
  store::ListOptions list;
  list.limit = kPage;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page, transaction.List(kKind, list));
    for (const store::Record& record : page) {
      stored::Files files;
      if (!files.ParseFromString(record.payload) || files.digests().size() % kDigestBytes != 0) {
        return absl::DataLossError(absl::StrCat("files of maps/", record.key, " cannot be read"));
      }
      for (std::size_t at = 0; at < files.digests().size(); at += kDigestBytes) {
        named->insert(absl::BytesToHexString(files.digests().substr(at, kDigestBytes)));
      }
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

}  // namespace mortise::interpolator
