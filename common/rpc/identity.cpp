#include "common/rpc/identity.h"

#include <array>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

constexpr std::array<const char*, 5> kRoleNames = {"none", "viewer", "designer", "operator",
                                                   "admin"};

}  // namespace

const char* RoleName(Role role) { return kRoleNames[static_cast<std::size_t>(role)]; }

absl::StatusOr<Role> ParseRole(std::string_view name, std::string_view field) {
  for (std::size_t i = 1; i < kRoleNames.size(); ++i) {
    if (name == kRoleNames[i]) return static_cast<Role>(i);
  }
  return InvalidField(field, "must be viewer, designer, operator or admin");
}

}  // namespace mortise::rpc
