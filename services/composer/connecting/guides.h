// What lets parts of a design move: hinges, drawer slides, pins on an axis, or the parts that
// something runs between. A joint of a design is of these, not of whatever else it touches.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "common/assembly/connections/connection.h"
#include "common/assembly/connections/connection_patch.h"
#include "common/assembly/model/assembly.h"
#include "common/design/template_definition.h"

namespace mortise::composer {

// Returns the kind of an item, "items/…"; nothing where that is not known.
using ItemKindOf = std::function<std::optional<parametric::ItemKind>(const std::string& item)>;

// Whether a connecting element of a connection, as drawn, lets a joint move what it moves:
//
//   a hinge         turns about an axis that goes through its box
//   a drawer slide  slides along its length
//   a bearing       turns about its axis, or slides along it
//   wheels, screws, bolts, rods, dowels, tubes
//                   let turn what is on them, if the axis or point goes through their box; those
//                   without a head that holds, all but screws and wheels, let slide along them
//   hardware, profiles, and items of which no kind is known
//                   turn about what goes through their box, and slide any way
//   all else        holds firmly: nuts, washers, brackets
bool LetsMove(const parametric::ElementConnection& connection, int element,
              const parametric::Joint& joint, const ItemKindOf& kind_of);

// Whether any connecting element of a connection does.
bool Guides(const parametric::ElementConnection& connection, const parametric::Joint& joint,
            const ItemKindOf& kind_of);

// Whether a connection has hinges, drawer slides or bearings, which nobody takes to hold firmly.
bool IsMadeToMove(const parametric::ElementConnection& connection, const ItemKindOf& kind_of);

// How what lies against something keeps it on its way, without any connecting element: guides from
// both sides, runners and covers; or as the pin that it is put on.
class Guidance {
 public:
  // Notes how two parts meet, of which one moves by the joint. `direction` is along the axis of
  // space across which they meet, from the one that moves to the other.
  void AddContact(const parametric::Joint& joint, const parametric::BoundingBox& moved,
                  const parametric::BoundingBox& other, parametric::Axis normal);

  // Whether two parts that meet so are noted as keeping it on its way: not those that it only
  // comes to rest against.
  static bool IsOfWay(const parametric::Joint& joint, parametric::Axis normal);

  // Whether it is kept on its way at all: from two opposite sides, or by a pivot.
  bool Keeps() const;
  // Whether it is kept from all that `other` keeps it from.
  bool Covers(const Guidance& other) const;

 private:
  std::array<std::array<bool, 2>, 3> is_blocked_ = {};  // towards lower and upper, by axis
  bool has_pivot_ = false;
};

}  // namespace mortise::composer
