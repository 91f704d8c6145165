// The token that a client's calls carry.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"

namespace mortise::cli {

// Thread safe.
class BearerToken {
 public:
  // Returns the token in `file`, or MORTISE_TOKEN if no file is named; empty if that is not set,
  // either. Fails as ReadFile does.
  static absl::StatusOr<std::unique_ptr<BearerToken>> Read(const std::string& file);

  std::string text() const;

  // Whether calls carry another token from now on than `refused`, for tokens expire and whoever
  // renews them writes the file anew.
  bool IsRenewed(const std::string& refused);

 private:
  BearerToken(std::string file, std::string text);

  const std::string file_;
  mutable std::mutex mutex_;
  std::string text_;  // guarded by mutex_
};

}  // namespace mortise::cli
