// What `mortise compose` prints of a model.
#pragma once

#include "cli/client/output.h"
#include "mortise/v1/composer.pb.h"

namespace mortise::cli {

// Prints a model for people: what made it so, its components, and what they should know of it. The
// whole of it is the document.
void PrintModel(const v1::Model& model, Output& output);

// Prints what is not as it should be in a model: what nothing connects, or holds.
void PrintWarnings(const v1::Model& model, const Output& output);

// Prints what a component snapped by, or was connected by.
void PrintComponent(const v1::Model& model, const std::string& component, const Output& output);

// Prints what a drag would make of a model: which parts would lie elsewhere, come and go.
void PrintPreview(const v1::DragPreview& preview, Output& output);

}  // namespace mortise::cli
