// Checks materials and items as messages: what cannot be read, and what makes no sense of that
// which can be. What only follows from something else that is told is left out. Target
// mortise_template_codec.
#pragma once

#include <limits>
#include <set>
#include <string>
#include <vector>

#include "common/design/template_validation.h"
#include "mortise/v1/item.pb.h"

namespace mortise::parametric {

// Paths of fields of which somebody said something that cannot be read and has been told of, as
// findings name them: "dimensions[X].size". Numbers among them are kUnreadNumber in the message.
using UnreadFields = std::set<std::string>;

inline constexpr double kUnreadNumber = std::numeric_limits<double>::quiet_NaN();

// Returns everything wrong with a material but what is `unread`.
std::vector<FieldViolation> ValidateMaterialMessage(const v1::Material& material,
                                                    const UnreadFields& unread = {});

// Returns everything wrong with an item but what is `unread`, and but its shape. `materials` are
// those that there are.
std::vector<FieldViolation> ValidateItemMessage(const v1::Item& item,
                                                const std::vector<Material>& materials,
                                                const UnreadFields& unread = {});

// Returns what is wrong with the shape of an item, of which there is no other: a size that the item
// fixes to another. Not along an axis of which something is unread.
std::vector<FieldViolation> CheckShapeOfItem(const v1::Item& item, const v1::Shape& shape,
                                             const UnreadFields& unread = {});

// Says that no shape has the name that the item gives.
FieldViolation MissingShape(const v1::Item& item);

}  // namespace mortise::parametric
