// The OpenAPI 3.1 description of everything the HTTP door answers, made from the contract.
#pragma once

#include <string>
#include <string_view>

namespace mortise::gateway {

class Contract;

// Returns one JSON document: a path for each method, a schema for each message, and the protos'
// comments as descriptions. `version` is that of the gateway.
std::string OpenApiDocument(const Contract& contract, std::string_view version);

}  // namespace mortise::gateway
