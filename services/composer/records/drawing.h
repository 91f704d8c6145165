// Drawings that a model is made of: assemblies as messages, which parametrise themselves, and how
// new ones are made of the parts of others.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::composer {

// An assembly whose parts all stand by themselves, with the items, materials and shapes that it
// uses, as they were when it was read. Its name is that of the assembly where it was found
// ("assemblies/bookshelf"), or the model's id.
struct Drawing {
  std::string digest;  // SHA-256 of all of it; shapes count by their names
  v1::AssemblyBundle bundle;
};

// Returns the names of the shapes that its parts have, their own or their items'.
std::set<std::string> ShapesUsed(const v1::AssemblyBundle& bundle);

// Puts the message of a part, with its prominent planes, where the part is and as large as it is.
void PutIntoBox(const parametric::AssemblyPart& part, v1::AssemblyPart* message);

// Adds a shape that no drawing knows, unless the bundle has it, and returns its name.
std::string AddOwnShape(const mesh::DrawnShape& shape, v1::AssemblyBundle* bundle);

// Leaves only the items, materials and shapes that the parts of the assembly use, sorted.
void KeepWhatIsUsed(v1::AssemblyBundle* bundle);

// Gives a bundle its digest. What is no content of the assembly (revision, tags, times) is left
// out, and so are those of items and materials in the digest.
Drawing MakeDrawing(v1::AssemblyBundle bundle);

// Returns the assembly as a struct. INVALID_ARGUMENT as parametric::FromProto.
absl::StatusOr<parametric::Assembly> ReadAssembly(const v1::AssemblyBundle& bundle);

// Returns a bundle in which each part of a row or grid is a part of its own, as
// parametric::FromProto names and places them. INVALID_ARGUMENT as it.
absl::StatusOr<Drawing> ReadDrawing(const v1::AssemblyBundle& bundle);

// Of which drawing a part or joint is a copy, and of which part or joint of it.
struct CopiedFrom {
  const Drawing* drawing = nullptr;
  std::string name;
  bool keeps_priority = true;  // of a part: that of its coming in (AssemblyPart)
};

// Returns an assembly as a drawing called `name`: each of its parts and joints as the one it is a
// copy of is described, where and as large as it is now, and under the name that it has now.
// Shapes that are not stored anywhere yet (Redraw) are stored with it. `parts` and `joints` are as
// many as the assembly's, and name what is in their drawings. FAILED_PRECONDITION as CombineItems.
absl::StatusOr<Drawing> DrawAnew(const std::string& name, const parametric::Assembly& assembly,
                                 const std::vector<CopiedFrom>& parts,
                                 const std::vector<CopiedFrom>& joints);

// Tells whether what is read from the drawing is this assembly to the last bit, so that it need not
// be parametrised again.
bool IsDrawnAs(const Drawing& drawing, const parametric::Assembly& assembly);

// FAILED_PRECONDITION, ITEM_DIFFERS, naming an item that is of another material, size or shape in
// one than in the other.
absl::Status CheckItems(const v1::AssemblyBundle& from, const v1::AssemblyBundle& to);

// Adds the items and materials of `from` that `to` has not; where both have an item or material,
// the later revision stays. Fails as CheckItems: what is made of such an item would not be the
// same.
absl::Status CombineItems(const v1::AssemblyBundle& from, v1::AssemblyBundle* to);

}  // namespace mortise::composer
