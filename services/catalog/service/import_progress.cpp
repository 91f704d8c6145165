#include "services/catalog/service/import_progress.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {

ImportProgress::ImportProgress(store::Store* store, std::string assembly, std::string request_id,
                               resources::Author author)
    : store_(store),
      assembly_(std::move(assembly)),
      is_name_(ParseResourceName(assembly_, kAssemblies, "name").ok()),
      request_id_(std::move(request_id)),
      author_(std::move(author)),
      next_(store->Now() + kQuietTime) {}

void ImportProgress::Tell(const std::string& stage, std::int64_t done, std::int64_t total) {
  const absl::Time now = store_->Now();
  if (!is_name_ || now < next_) return;
  next_ = now + kPauseBetweenEvents;
  const absl::Status told = store_->Transact([&](store::Transaction& transaction) {
    return AppendEvent(
        transaction, "assembly.importing", assembly_,
        {{"request_id", request_id_}, {"stage", stage}, {"done", done}, {"total", total}}, author_);
  });
  if (!told.ok()) {
    Log(LogLevel::kWarning, "how far an import is could not be told",
        {{"assembly", assembly_}, {"error", told.ToString()}});
  }
}

}  // namespace mortise::catalog
