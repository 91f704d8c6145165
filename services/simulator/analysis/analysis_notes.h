// What one should know of an analysis, in words: numbers that cannot be meant, and a mesh that is
// coarser than usual.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/fem/elements/material.h"
#include "common/mesh/tetrahedra/element_budget.h"

namespace mortise::simulator {

// Returns a note on each modulus of elasticity outside 1 MPa (rubber has several) to 2 TPa (diamond
// has 1.2) and each density outside 0.1 kg/m³ (aerogels have 1) to 30,000 kg/m³ (osmium has
// 22,600), with the material's name, the field, and what may have been meant: most are numbers in
// GPa, MPa or g/mm³. Each material is named once. 0 is no density, but an unknown one.
std::vector<std::string> NotesOnMaterials(const std::vector<Material>& materials);

// Returns a note where a displacement of `largest`, m, is larger than the box around the nodes, m,
// is from corner to corner: what is linear means nothing there. Empty where it is not.
std::string NoteOnDisplacement(double largest, const Eigen::Matrix3Xd& nodes);

// Returns a note on a mesh that has been made coarser than its elements would be by default: how
// wide they are, and how to have finer ones. Empty where it has not.
std::string NoteOnBudget(const mesh::BudgetedMesh& mesh, const mesh::ElementBudget& budget);

}  // namespace mortise::simulator
