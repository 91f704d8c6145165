#include "services/composer/model/removal.h"

#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"

namespace mortise::composer {

absl::StatusOr<parametric::Assembly> WithoutNode(const Design& design, const std::string& node) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly drawn, DrawnAt(design));
  absl::StatusOr<parametric::Assembly> left = parametric::WithoutSubTree(drawn, node);
  if (DetailOf(left.status()).field == "group") {
    return WithDetail(left.status(), {DetailOf(left.status()).reason, "node"});
  }
  return left;
}

}  // namespace mortise::composer
