// Which assemblies of a collection may hold what is to be connected.
#include "services/composer/catalog/collection_connections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;

struct MadeOf {
  std::string item, material;
};

Drawing DrawingOf(const std::vector<MadeOf>& items) {
  Drawing drawing;
  for (const MadeOf& each : items) {
    v1::Item& item = *drawing.bundle.add_items();
    item.set_name(each.item);
    item.set_material(each.material);
  }
  return drawing;
}

const std::vector<MadeOf>& Items() {
  static const auto* const items = new std::vector<MadeOf>{{"items/oak-board", "materials/oak"},
                                                           {"items/oak-post", "materials/oak"},
                                                           {"items/steel-tube", "materials/steel"},
                                                           {"items/felt", ""}};
  return *items;
}

// An assembly with one connection of such principals, and of a screw unless they only touch.
ConnectionOrigin Connecting(const std::vector<std::string>& principals, bool with_screw = true) {
  CollectionConnection connection;
  connection.source = "assemblies/some";
  parametric::ElementConnection& made = connection.connection;
  for (const std::string& item : principals) {
    made.principals.push_back(static_cast<int>(made.elements.size()));
    made.elements.emplace_back().item = item;
  }
  if (with_screw) {
    made.connecting.push_back(static_cast<int>(made.elements.size()));
    made.elements.emplace_back().item = "items/screw";
  }
  return {.drawing = std::make_shared<const Drawing>(DrawingOf(Items())),
          .connections = std::make_shared<const Connections>(Connections{std::move(connection)})};
}

std::vector<std::string> NamesOf(const ConnectionOrigins& origins) {
  std::vector<std::string> names;
  for (const auto& [name, origin] : origins) names.push_back(name);
  return names;
}

TEST(ThatMayHold, AreThoseBetweenTheMaterialsOfBoth) {
  ConnectionOrigins origins;
  origins["oak to oak"] = Connecting({"items/oak-board", "items/oak-post"});
  origins["oak to oak, glued"] = Connecting({"items/oak-board", "items/oak-post"}, false);
  origins["oak to steel"] = Connecting({"items/oak-post", "items/steel-tube"});
  origins["steel to steel"] = Connecting({"items/steel-tube", "items/steel-tube"});
  origins["oak to felt"] = Connecting({"items/felt", "items/oak-board"});
  origins["oak to what nobody knows"] = Connecting({"items/oak-board", "items/unknown"});
  const Drawing oak = DrawingOf({{"items/oak-plank", "materials/oak"}});
  const Drawing steel = DrawingOf({{"items/steel-bar", "materials/steel"}});
  const Drawing felt = DrawingOf({{"items/felt", ""}});
  EXPECT_THAT(NamesOf(ThatMayHold(origins, oak, oak)), ElementsAre("oak to oak"));
  EXPECT_THAT(NamesOf(ThatMayHold(origins, oak, steel)), ElementsAre("oak to steel"));
  EXPECT_THAT(NamesOf(ThatMayHold(origins, steel, oak)), ElementsAre("oak to steel"));
  EXPECT_THAT(NamesOf(ThatMayHold(origins, oak, felt)), ElementsAre("oak to felt"));
  EXPECT_THAT(NamesOf(ThatMayHold(origins, felt, steel)), ElementsAre());
}

}  // namespace
}  // namespace mortise::composer
