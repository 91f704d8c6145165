#include "common/base/temporary_folder.h"

#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "common/base/identifiers.h"

namespace mortise {

TemporaryFolder::TemporaryFolder(std::string_view purpose)
    : path_(std::filesystem::temp_directory_path() /
            absl::StrCat("mortise-", absl::string_view(purpose.data(), purpose.size()), "-",
                         NewIdentifier())) {
  std::error_code ignored;
  if (!std::filesystem::create_directory(path_, ignored)) return;
  std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace mortise
