#include "common/assembly/memory_use.h"

#include <set>

#include "common/assembly/parametric_assembly.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kText = 64;  // bytes of a short text and what allocating it takes
// A relationship is kept as it was found, by the feasible set, and there again among its equalities
// or inequalities; the feasible set is kept twice.
constexpr std::size_t kRelationshipCopies = 5;
// A part or element, with its names, limits and planes, is kept by the assembly, by the check of
// contacts and by the rest poses.
constexpr std::size_t kPart = 3 * (sizeof(AssemblyPart) + sizeof(Element) + 16 * kText);
constexpr std::size_t kMeeting = 3;  // bytes, of two elements in a pose

template <class Matrix>
std::size_t BytesOf(const Matrix& matrix) {
  return static_cast<std::size_t>(matrix.size()) * sizeof(typename Matrix::Scalar);
}

std::size_t BytesOf(const Relationship& relationship) {
  return sizeof(Relationship) + relationship.form.terms.capacity() * sizeof(LinearTerm) +
         relationship.description.capacity() + kText;
}

}  // namespace

std::size_t MemoryUse(const mesh::DrawnShape& shape) {
  std::size_t bytes = sizeof(shape) + shape.name.capacity() + shape.brep.capacity() +
                      BytesOf(shape.fractions) + BytesOf(shape.triangles) +
                      BytesOf(shape.triangle_face) + BytesOf(shape.missed_volumes);
  for (const std::vector<std::string>& names : shape.face_names) {
    bytes += sizeof(names) + names.size() * kText;
  }
  return bytes + shape.planes.size() * (sizeof(mesh::ShapePlane) + kText);
}

std::size_t MemoryUse(const ParametricAssembly& assembly) {
  std::size_t bytes = sizeof(assembly) + assembly.assembly().parts.size() * kPart +
                      assembly.solved_systems()->MemoryUse();
  std::set<const mesh::DrawnShape*> shapes;
  const auto count = [&](const mesh::DrawnShape* shape) {
    if (shape != nullptr && shapes.insert(shape).second) bytes += MemoryUse(*shape);
  };
  for (const AssemblyPart& part : assembly.assembly().parts) count(part.shape.get());
  for (const Element& element : assembly.elements()) count(element.shape.get());
  for (const Relationship& relationship : assembly.relationships()) {
    bytes += kRelationshipCopies * BytesOf(relationship);
  }
  const FeasibleSet& feasible = assembly.feasible_set();
  const std::size_t freedom = static_cast<std::size_t>(feasible.degrees_of_freedom());
  // The basis, twice, and of the placement of connecting elements one as large at most, twice.
  bytes += 4 * BytesOf(feasible.basis());
  // Inequalities over the degrees of freedom, here, twice, and in the placement.
  bytes += 3 * feasible.inequalities().size() * freedom * sizeof(double);
  std::size_t poses = 1;
  for (const Joint& joint : assembly.assembly().joints) poses += joint.rest_poses.size();
  const std::size_t elements = assembly.elements().size();
  return bytes + poses * elements * elements * kMeeting;
}

}  // namespace mortise::parametric
