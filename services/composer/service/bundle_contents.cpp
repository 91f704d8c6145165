#include "services/composer/service/bundle_contents.h"

#include <utility>

#include "common/base/errors.h"
#include "common/files/template_codec.h"

namespace mortise::composer {

absl::StatusOr<BundleContents> ContentsOf(const v1::AssemblyBundle& bundle) {
  BundleContents contents;
  for (const v1::Item& message : bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
    contents.items.push_back(std::move(item));
  }
  for (const v1::Material& message : bundle.materials()) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Material material, parametric::FromProto(message));
    contents.materials.push_back(std::move(material));
  }
  return contents;
}

}  // namespace mortise::composer
