// Says of which parts and joints of designs that ship those of a composed model are copies.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/composer/connecting/connect.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// A part or joint of a design that ships.
struct ShippedOrigin {
  std::string design;  // "bookshelf", or "assemblies/bookshelf"
  std::string name;
};

// By the name of a part or joint of a body's assembly: what it is a copy of.
using ShippedOrigins = std::map<std::string, ShippedOrigin>;

// The body of a model, with what its parts and joints are copies of.
struct ComposedBody {
  Design design;
  ShippedOrigins parts, joints;
};

// The body is a sub-tree of `design`, with these parts or joints.
template <typename Named>
ShippedOrigins OriginsIn(const std::vector<Named>& named, const std::string& design) {
  ShippedOrigins origins;
  for (const Named& one : named) origins[one.name] = {design, one.name};
  return origins;
}

// The body was made of one with the origins `before`, and of a piece of the design `piece`.
template <typename Named>
ShippedOrigins OriginsOf(const std::vector<Named>& named,
                         const std::vector<Provenance>& provenances, const ShippedOrigins& before,
                         const std::string& piece) {
  ShippedOrigins origins;
  for (std::size_t i = 0; i < named.size(); ++i) {
    const Provenance& from = provenances[i];
    const bool of_piece = from.from == Provenance::From::kComponent;
    origins[named[i].name] = from.from == Provenance::From::kBody
                                 ? before.at(from.name)
                                 : ShippedOrigin{of_piece ? piece : from.source, from.name};
  }
  return origins;
}

// The body is drawn anew as others are removed from it.
inline ShippedOrigins OriginsOf(const Redrawn& redrawn, const ShippedOrigins& before) {
  ShippedOrigins origins;
  for (std::size_t i = 0; i < redrawn.drawn_as.size(); ++i) {
    origins[redrawn.assembly.parts[i].name] = before.at(redrawn.drawn_as[i]);
  }
  return origins;
}

}  // namespace mortise::composer
