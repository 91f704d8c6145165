// Who changes resources, and under which request.
#pragma once

#include <string>

namespace mortise::resources {

struct Author {
  std::string user;      // "users/ada", "services/catalog"; becomes the creator of what is new
  std::string trace_id;  // of the request, for the events it causes; empty if there is none
};

}  // namespace mortise::resources
