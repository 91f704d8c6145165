// Assemblies at the catalog that are parametrised.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"

namespace mortise::catalog {

class AssemblyParametrizationTest : public AssemblyServiceTest {
 protected:
  absl::StatusOr<std::vector<v1::AdjustedAssembly>> Evaluate(
      const v1::EvaluateAssemblyRequest& request) {
    grpc::ClientContext context;
    testing::Prepare(context);
    return ReadAll(stub_->EvaluateAssembly(&context, request));
  }

  v1::Parametrization Parametrized() { return ParametrizationOf(kShelf); }

  absl::StatusOr<v1::Assembly> Import(const v1::Assembly& assembly, int64_t expected) {
    v1::ImportAssemblyRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    *request.mutable_assembly() = assembly;
    request.set_expected_revision(expected);
    return Call(&Stub::ImportAssembly, request);
  }
};

}  // namespace mortise::catalog
