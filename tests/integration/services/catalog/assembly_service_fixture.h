// The catalog as a process, with the assemblies that ship, and calls of its AssemblyService.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"

namespace mortise::catalog {

class AssemblyServiceTest : public ::testing::Test {
 protected:
  using Stub = v1::AssemblyService::Stub;

  AssemblyServiceTest() { Connect(); }

  void Connect() { stub_ = v1::AssemblyService::NewStub(process_.channel()); }

  template <typename Request, typename Response>
  absl::StatusOr<Response> Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                             Response*),
                                const Request& request) {
    return testing::Call(*stub_, method, request);
  }

  template <typename Reader>
  static absl::StatusOr<std::vector<v1::AdjustedAssembly>> ReadAll(const Reader& reader) {
    std::vector<v1::AdjustedAssembly> designs;
    v1::AdjustedAssembly design;
    while (reader->Read(&design)) designs.push_back(design);
    const absl::Status status = rpc::FromGrpc(reader->Finish());
    if (!status.ok()) return status;
    return designs;
  }

  absl::StatusOr<std::vector<v1::AdjustedAssembly>> Sample(int count, uint64_t seed) {
    v1::SampleAssemblyRequest request;
    request.set_name(kShelf);
    request.set_count(count);
    request.set_seed(seed);
    grpc::ClientContext context;
    testing::Prepare(context);
    return ReadAll(stub_->SampleAssembly(&context, request));
  }

  v1::Assembly Get(const std::string& name, int64_t revision = 0) {
    v1::GetAssemblyRequest request;
    request.set_name(name);
    request.set_revision(revision);
    const auto found = Call(&Stub::GetAssembly, request);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.ok() ? *found : v1::Assembly();
  }

  v1::Parametrization ParametrizationOf(const std::string& name) {
    v1::ParametrizeAssemblyRequest request;
    request.set_name(name);
    const auto found = Call(&Stub::ParametrizeAssembly, request);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or(v1::Parametrization());
  }

  static constexpr char kShelf[] = "assemblies/bookshelf";

  int requests_ = 0;
  testing::FilledCatalog process_;
  std::unique_ptr<Stub> stub_;
};

}  // namespace mortise::catalog
