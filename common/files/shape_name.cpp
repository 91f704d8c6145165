#include "common/files/shape_name.h"

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "mortise/v1/item.pb.h"

namespace mortise::parametric {

std::string NameOf(v1::Shape message) {
  message.clear_name();
  return absl::StrCat("shapes/", Sha256Hex(message.SerializeAsString()));
}

}  // namespace mortise::parametric
