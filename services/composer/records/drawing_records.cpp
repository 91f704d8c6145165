#include "services/composer/records/drawing_records.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/resources/record_page.h"

namespace mortise::composer {
namespace {

// What comes behind the first part of a name: "desk" of "models/desk".
std::string EndOf(const std::string& name) { return name.substr(name.find('/') + 1); }

std::string KeyOf(const std::string& model, const std::string& digest) {
  return absl::StrCat(EndOf(model), "/", digest);
}

absl::Status PutIfMissing(store::Transaction& transaction, const char* kind, const std::string& key,
                          const google::protobuf::Message& message) {
  const absl::Status present = transaction.Get(kind, key).status();
  if (!absl::IsNotFound(present)) return present;
  return transaction.Put(kind, key, message.SerializeAsString()).status();
}

template <typename Message>
absl::StatusOr<Message> Get(store::ReadTransaction& transaction, const char* kind,
                            const std::string& key) {
  const absl::StatusOr<store::Record> record = transaction.Get(kind, key);
  if (absl::IsNotFound(record.status())) {
    return StorageFailed(absl::StrCat(kind, "/", key), "is missing");
  }
  MORTISE_RETURN_IF_ERROR(record.status());
  return resources::ParseRecord<Message>(kind, *record);
}

}  // namespace

absl::Status PutDrawing(store::Transaction& transaction, const std::string& model,
                        const Drawing& drawing) {
  v1::AssemblyBundle content = drawing.bundle;
  content.clear_shapes();
  MORTISE_RETURN_IF_ERROR(
      PutIfMissing(transaction, kDrawings, KeyOf(model, drawing.digest), content));
  for (const v1::Shape& shape : drawing.bundle.shapes()) {
    MORTISE_RETURN_IF_ERROR(
        PutIfMissing(transaction, kShapes, KeyOf(model, EndOf(shape.name())), shape));
  }
  return absl::OkStatus();
}

absl::StatusOr<Drawing> GetDrawing(store::ReadTransaction& transaction, const std::string& model,
                                   const std::string& digest) {
  Drawing drawing{.digest = digest, .bundle = {}};
  MORTISE_ASSIGN_OR_RETURN(drawing.bundle, Get<v1::AssemblyBundle>(transaction, kDrawings,
                                                                   KeyOf(model, drawing.digest)));
  for (const std::string& name : ShapesUsed(drawing.bundle)) {
    MORTISE_ASSIGN_OR_RETURN(*drawing.bundle.add_shapes(),
                             Get<v1::Shape>(transaction, kShapes, KeyOf(model, EndOf(name))));
  }
  return drawing;
}

}  // namespace mortise::composer
