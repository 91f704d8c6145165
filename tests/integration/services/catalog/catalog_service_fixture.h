// The catalog as a process, with the collection that ships, and calls of it.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/filled_catalog.h"

namespace mortise::catalog {

// What a failed call says: code, reason and field.
struct Failure {
  absl::StatusCode code;
  std::string reason;
  std::string field;
  std::string message;
};

class CatalogServiceTest : public ::testing::Test {
 protected:
  CatalogServiceTest() { Connect(); }

  void Connect() { stub_ = v1::CatalogService::NewStub(process_.channel()); }

  template <typename Request, typename Response>
  grpc::Status Call(grpc::Status (v1::CatalogService::Stub::*method)(grpc::ClientContext*,
                                                                     const Request&, Response*),
                    const Request& request, Response* response) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    context.set_wait_for_ready(true);
    return ((*stub_).*method)(&context, request, response);
  }

  template <typename Request, typename Response>
  Failure Fail(grpc::Status (v1::CatalogService::Stub::*method)(grpc::ClientContext*,
                                                                const Request&, Response*),
               const Request& request) {
    Response response;
    const absl::Status status = rpc::FromGrpc(Call(method, request, &response));
    EXPECT_FALSE(status.ok());
    return {status.code(), DetailOf(status).reason, DetailOf(status).field,
            std::string(status.message())};
  }

  v1::Item GetItem(const std::string& name, int64_t revision = 0) {
    v1::GetItemRequest request;
    request.set_name(name);
    request.set_revision(revision);
    v1::Item item;
    const grpc::Status status = Call(&v1::CatalogService::Stub::GetItem, request, &item);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return item;
  }

  v1::Template GetTemplate(const std::string& name, int64_t revision = 0) {
    v1::GetTemplateRequest request;
    request.set_name(name);
    request.set_revision(revision);
    v1::Template message;
    const grpc::Status status = Call(&v1::CatalogService::Stub::GetTemplate, request, &message);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return message;
  }

  static std::string NewRequestId() {
    static int count = 0;
    return "request-" + std::to_string(++count);
  }

  v1::ImportTemplateRequest ImportRequest(const v1::Template& message, int64_t expected) {
    v1::ImportTemplateRequest request;
    request.set_request_id(NewRequestId());
    *request.mutable_template_() = message;
    request.set_expected_revision(expected);
    return request;
  }

  absl::StatusOr<std::string> Export(const v1::ExportDesignRequest& request,
                                     v1::Chunk* first = nullptr) {
    grpc::ClientContext context;
    auto reader = stub_->ExportDesign(&context, request);
    std::string bytes, sha256;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) {
      EXPECT_EQ(chunk.offset(), static_cast<int64_t>(bytes.size()));
      if (chunk.offset() == 0) {
        sha256 = chunk.sha256();
        if (first != nullptr) *first = chunk;
      }
      bytes += chunk.data();
    }
    const absl::Status status = rpc::FromGrpc(reader->Finish());
    if (!status.ok()) return status;
    EXPECT_EQ(Sha256Hex(bytes), sha256);
    return bytes;
  }

  testing::FilledCatalog process_;
  std::unique_ptr<v1::CatalogService::Stub> stub_;
};

}  // namespace mortise::catalog
