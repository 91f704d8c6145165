// Shapes at the catalog as a process.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::catalog {

template <typename Message>
Message Parse(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

class ShapeServiceTest : public ::testing::Test {
 protected:
  absl::StatusOr<v1::ImportAssemblyStepResponse> ImportStep(const std::string& step,
                                                            const std::string& annotations) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id(NextId());
    request.set_step(step);
    *request.mutable_annotations() = Parse<v1::AssemblyAnnotations>(annotations);
    return testing::Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssemblyStep, request);
  }

  absl::StatusOr<v1::Shape> ImportShape(const std::string& file,
                                        v1::ImportShapeRequest::Format format) {
    v1::ImportShapeRequest request;
    request.set_request_id(NextId());
    request.set_file(file);
    request.set_format(format);
    return testing::Call(*catalog_, &v1::CatalogService::Stub::ImportShape, request);
  }

  v1::Shape Shape(const std::string& name) {
    v1::GetShapeRequest request;
    request.set_name(name);
    const auto shape = testing::Call(*catalog_, &v1::CatalogService::Stub::GetShape, request);
    EXPECT_TRUE(shape.ok()) << shape.status();
    return shape.value_or(v1::Shape());
  }

  absl::StatusOr<std::string> Export(const std::string& text) {
    grpc::ClientContext context;
    testing::Prepare(context);
    return testing::ReadChunks(
        *assemblies_->ExportAssembly(&context, Parse<v1::ExportAssemblyRequest>(text)));
  }

  absl::StatusOr<std::string> ExportTemplate(const std::string& text) {
    grpc::ClientContext context;
    testing::Prepare(context);
    return testing::ReadChunks(
        *catalog_->ExportDesign(&context, Parse<v1::ExportDesignRequest>(text)));
  }

  std::string NextId() { return absl::StrCat("shapes-", ++requests_); }

  int requests_ = 0;
  testing::ServiceUnderTest process_{"mortise-catalog", {}};
  std::unique_ptr<v1::AssemblyService::Stub> assemblies_ =
      v1::AssemblyService::NewStub(process_.channel());
  std::unique_ptr<v1::CatalogService::Stub> catalog_ =
      v1::CatalogService::NewStub(process_.channel());
};

inline const cad::StepPart& PartOf(const cad::StepAssembly& assembly, const std::string& name) {
  static const cad::StepPart none;
  for (const cad::StepPart& part : assembly.parts) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "no part " << name;
  return none;
}

inline std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty() && !status.ok()) fields.push_back(DetailOf(status).field);
  return fields;
}

}  // namespace mortise::catalog
