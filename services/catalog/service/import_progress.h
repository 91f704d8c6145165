// Tells how far an import is, for people who wait for it.
#pragma once

#include <cstdint>
#include <string>

#include "absl/time/time.h"
#include "common/resources/author.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Appends events "assembly.importing" about an assembly to the outbox, with the data {"request_id",
// "stage", "done", "total"}: which call it is, what it does, how much of that it has done, and of
// how much, 0 where that is not counted. The first comes when the import has taken kQuietTime, the
// next ones kPauseBetweenEvents after the one before, so that quick imports tell nothing and long
// ones little. Whoever calls follows the events of the catalog while it waits. What cannot be told
// is not: the import goes on. For one thread.
class ImportProgress {
 public:
  static constexpr absl::Duration kQuietTime = absl::Milliseconds(500);
  static constexpr absl::Duration kPauseBetweenEvents = absl::Seconds(1);

  // `store` outlives it. `request_id` is the caller's.
  ImportProgress(store::Store* store, std::string assembly, std::string request_id,
                 resources::Author author);

  void Tell(const std::string& stage, std::int64_t done, std::int64_t total);

 private:
  store::Store* const store_;
  const std::string assembly_;
  const bool is_name_;  // of an assembly: nothing is told of what is about to be refused
  const std::string request_id_;
  const resources::Author author_;
  absl::Time next_;  // when the next event may be told
};

}  // namespace mortise::catalog
