// A catalog that serves the collection's table on loopback, from the test's own process.
#pragma once

#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "common/base/files.h"
#include "common/parametric/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::simulator {

class TableCatalog final : public v1::CatalogService::Service {
 public:
  TableCatalog() {
    const std::filesystem::path collection = std::filesystem::path(SourceFolder()) / "collection";
    Merge(collection / "materials.textproto", bundle_);
    for (const auto& entry : std::filesystem::directory_iterator(collection / "items")) {
      Merge(entry.path(), bundle_);
    }
    Merge(collection / "designs/table/template.textproto", *bundle_.mutable_template_());
    bundle_.mutable_template_()->set_revision(1);
    bundle_.mutable_template_()->set_digest(parametric::TemplateDigest(bundle_.template_()));
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~TableCatalog() override { server_->Shutdown(); }

  const std::string& address() const { return address_; }
  const v1::Template& table() const { return bundle_.template_(); }

  grpc::Status GetTemplateBundle(grpc::ServerContext*, const v1::GetTemplateBundleRequest* request,
                                 v1::TemplateBundle* response) override {
    if (request->name() != "templates/table" || request->revision() > 1) {
      return {grpc::StatusCode::NOT_FOUND, "no such template revision: " + request->name()};
    }
    *response = bundle_;
    return grpc::Status::OK;
  }

 private:
  static std::string SourceFolder() {
    const char* folder = std::getenv("MORTISE_SOURCE_DIR");
    return folder == nullptr ? "." : folder;
  }

  static void Merge(const std::filesystem::path& file, google::protobuf::Message& message) {
    const std::string text = ReadFile(file).value();
    if (!google::protobuf::TextFormat::MergeFromString(text, &message)) {
      throw std::runtime_error("cannot parse " + file.string());
    }
  }

  v1::TemplateBundle bundle_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace mortise::simulator
