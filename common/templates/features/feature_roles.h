// Says which faces each kind of feature makes, known before any solid is made. Private to this
// folder.
#pragma once

#include <map>
#include <string>

#include "common/templates/features/cad_template.h"

namespace mortise::cad {

using FeaturesByName = std::map<std::string, const Feature*>;

// Whether the feature makes a solid that a pattern can repeat.
bool MakesSolid(const Feature& feature);

// Whether it leaves of a body what both share.
bool Intersects(const Feature& feature);

// Whether `feature` can make faces of this role; empty means any. Its sketch is looked up in
// `earlier`; if it is not there, which is a finding of its own, every role is possible.
bool MakesFace(const Feature& feature, const std::string& role, const FeaturesByName& earlier);

}  // namespace mortise::cad
