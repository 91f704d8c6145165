// What really joins the parts of a model: screws, bolts, dowels, brackets, joint by joint.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/design/template_definition.h"
#include "services/composer/connecting/part_connection.h"

namespace mortise::composer {

enum class FastenerKind {
  kScrew,  // an item of that kind with a wood screw's or a machine's thread
  kBolt,   // bolts and threaded rods
  kDowel,
  kHardware,  // all else: brackets, hinges, slides, nuts, what no item says
};

// A connecting part.
struct Fastener {
  std::string name;
  std::string item;  // items/{id}
  FastenerKind kind = FastenerKind::kHardware;
  parametric::ItemKind item_kind = parametric::ItemKind::kHardware;
  int axis = 0;         // of what is a pin (all but hardware), along which it is long
  double diameter = 0;  // m, of a pin; of a screw, of its thread
  parametric::BoundingBox box;

  bool IsPin() const { return kind != FastenerKind::kHardware; }
};

// A principal part of a joint.
struct JoinedPart {
  std::string name;
  parametric::BoundingBox box;
  bool is_box = true;     // it fills its box nearly, so that distances from its faces are true
  bool is_metal = false;  // by the density of its material
  bool turns = false;     // a wheel or bearing
};

struct Joint {
  std::vector<JoinedPart> principals;
  std::vector<Fastener> fasteners;  // none: they only touch
  double length = 0;   // m, of the longest contact between two principals; 0 without one
  bool moves = false;  // a joint of the assembly moves some of them against others
};

// A connecting part as a fastener. One whose item is not among `items` is hardware.
Fastener FastenerOf(const parametric::AssemblyPart& part,
                    const std::vector<parametric::Item>& items);

// A principal part as part of a joint.
JoinedPart JoinedPartOf(const parametric::AssemblyPart& part,
                        const std::vector<parametric::Item>& items,
                        const std::vector<parametric::Material>& materials);

// Returns the joints of an assembly as it is drawn: its connections part by part (ConnectionsOf).
// Items that are not among `items` make hardware.
std::vector<Joint> JointsOf(const parametric::Assembly& drawn,
                            const std::vector<CollectionConnection>& connections,
                            const std::vector<parametric::Item>& items,
                            const std::vector<parametric::Material>& materials);

// Returns the names of the principal parts of an assembly, in order.
std::vector<std::string> PrincipalNames(const parametric::Assembly& drawn);

// Returns how long a pin is in a part, m: along its axis, where it is within the part across it, or
// at least reaches into it; 0 if it does not.
double DepthIn(const Fastener& pin, const JoinedPart& part);

// Whether two pins have one axis, within half the thinner one's diameter.
bool AreCoaxial(const Fastener& a, const Fastener& b);

}  // namespace mortise::composer
