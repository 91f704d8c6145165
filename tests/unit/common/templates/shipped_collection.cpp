#include "tests/unit/common/templates/shipped_collection.h"

#include <cstdlib>
#include <filesystem>

namespace mortise::templates {
namespace {

v1::TemplateBundle EverythingThatShips() {
  v1::TemplateBundle bundle;
  const parametric::Collection& collection = ShippedCollection();
  *bundle.mutable_items() = {collection.items.begin(), collection.items.end()};
  *bundle.mutable_materials() = {collection.materials.begin(), collection.materials.end()};
  *bundle.mutable_shapes() = {collection.shapes.begin(), collection.shapes.end()};
  return bundle;
}

}  // namespace

const parametric::Collection& ShippedCollection() {
  static const auto* const collection = [] {
    const char* source = std::getenv("MORTISE_SOURCE_DIR");
    const std::filesystem::path root = source == nullptr ? "." : source;
    return new parametric::Collection(parametric::ReadCollection(root / "collection").value());
  }();
  return *collection;
}

v1::TemplateBundle ShippedTemplate(const std::string& name) {
  v1::TemplateBundle bundle = EverythingThatShips();
  for (const v1::Template& message : ShippedCollection().templates) {
    if (message.name() == name) *bundle.mutable_template_() = message;
  }
  return bundle;
}

v1::TemplateBundle ShippedAssembly(const std::string& name) {
  v1::TemplateBundle bundle = EverythingThatShips();
  for (const v1::Assembly& message : ShippedCollection().assemblies) {
    if (message.name() == name) *bundle.mutable_assembly() = message;
  }
  bundle.mutable_template_()->set_name("templates" + name.substr(name.find('/')));
  bundle.mutable_template_()->mutable_assembly()->set_assembly(name);
  return bundle;
}

}  // namespace mortise::templates
